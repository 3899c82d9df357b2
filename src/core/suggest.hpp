#pragma once
// "Did you mean ...": the nearest of the known names to a name that is none of them.

#include <string>
#include <string_view>
#include <vector>

namespace vitrum {

/// Number of insertions, deletions, replacements and swaps of neighbours that turn `a` into `b` (optimal string
/// alignment distance), upper and lower case counting as equal.
int edit_distance(std::string_view a, std::string_view b);

/// A mend for a name that is not among `known`: "did you mean 'eye'? known: eye, look_at, up". Names are listed in the
/// order given, at most a dozen of them; `what` says what they are ("keys", "materials").
std::string suggestion(std::string_view name, const std::vector<std::string>& known, std::string_view what);

}  // namespace vitrum
