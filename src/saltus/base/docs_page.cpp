#include "saltus/base/docs_page.hpp"

namespace saltus {

std::string docs_page(std::string_view page, std::string_view anchor) {
  const bool is_source = docs_address.empty();
  std::string address = is_source ? "docs/" : std::string(docs_address);
  address.append(page).append(is_source ? ".md" : ".html");
  if (!anchor.empty()) address.append("#").append(anchor);
  return address;
}

}  // namespace saltus
