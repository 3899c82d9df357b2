#pragma once

namespace vitrum {

/// Version of vitrum, "major.minor.patch".
const char* version();

/// The commit that was built, with "+" behind it if the tree differed from it; "" where the tree was no clone.
const char* commit();

}  // namespace vitrum
