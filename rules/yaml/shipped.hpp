#pragma once

#include <span>
#include <string_view>

namespace gnomon::rules {

/// A rule base that comes with the library, as the text of rules/NAME.yaml.
struct ShippedRuleBase {
    std::string_view name;
    std::string_view text;
};

/// `default` first, then `quality`, `battery` and `thesis`.
std::span<const ShippedRuleBase> shippedRuleBases() noexcept;

/// The text of one of them, or an empty view.
std::string_view shippedRuleBase(std::string_view name) noexcept;

} // namespace gnomon::rules
