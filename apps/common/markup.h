// Text inside SVG and HTML.
#pragma once

#include <string>

namespace surefoot::apps {

// The text with &, < and > as character references.
inline std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&') {
      out += "&amp;";
    } else if (c == '<') {
      out += "&lt;";
    } else if (c == '>') {
      out += "&gt;";
    } else {
      out.push_back(c);
    }
  }
  return out;
}

}  // namespace surefoot::apps
