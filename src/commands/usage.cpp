#include "commands/usage.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <vector>

#include "core/printed.hpp"
#include "core/suggest.hpp"

namespace vitrum {
namespace {

std::vector<std::string> command_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(command->get_name());
  return names;
}

/// "--help", "--set", ...: what may begin a word of `command`.
std::vector<std::string> option_names(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

}  // namespace

Error usage_error(const CLI::App& app, const CLI::ParseError& error) {
  const std::vector<CLI::App*> chosen = app.get_subcommands();
  const CLI::App& command = chosen.empty() ? app : *chosen.front();
  const std::string help = chosen.empty() ? "`vitrum --help`" : "`vitrum " + command.get_name() + " --help`";
  const std::vector<std::string> unknown = app.remaining(true);
  if (dynamic_cast<const CLI::ExtrasError*>(&error) == nullptr && !(chosen.empty() && !unknown.empty()))
    return {{}, error.what(), help + " shows what is wanted"};
  const std::string& word = unknown.front();
  if (word.rfind('-', 0) == 0)
    return {{word}, chosen.empty() ? "there is no such option before the command" : "there is no such option",
            suggestion(word.substr(0, word.find('=')), option_names(command), "options")};
  if (chosen.empty()) return {{word}, "there is no such command", suggestion(word, command_names(app), "commands")};
  return {{word}, "this is one word too many", "put text with spaces between quotes; " + help + " shows what is wanted"};
}

uint64_t whole_number(const std::string& option, const std::string& text, uint64_t least, uint64_t most) {
  uint64_t number = 0;
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool is_number = !text.empty() && std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
  if (!is_number || fault != std::errc() || number < least || number > most)
    throw Error({option + " " + text}, is_number ? "this number is out of range" : "this is no whole number",
                "write digits only, for a number from " + std::to_string(least) + " to " + std::to_string(most));
  return number;
}

double real_number(const std::string& place, const std::string& text, double least, double most) {
  double number = 0.0;
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool is_number = fault == std::errc() && end == text.data() + text.size() && !std::isnan(number);
  if (!is_number || number < least || number > most) {
    throw Error({place}, is_number ? "this number is out of range" : "this is no number",
                printed("write a number from %g to %g, as in 0.001 or 1e-3", least, most));
  }
  return number;
}

}  // namespace vitrum
