#pragma once
// `vitrum verify --report-markdown`: what vitrum's numbers are worth, for a reader. docs/accuracy.md is one.

#include <string>
#include <utility>
#include <vector>

#include "commands/verify_run.hpp"

namespace vitrum {

/// A text in Markdown and the files that it shows.
struct Document {
  std::string text;
  std::vector<std::pair<std::string, std::string>> files;  ///< name and bytes
};

/// The document links to its files in `folder`, a path from where the text is kept.
Document verify_document(const VerifyRun& run, const std::string& folder);

}  // namespace vitrum
