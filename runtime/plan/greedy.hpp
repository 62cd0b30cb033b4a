#pragma once
/// One method per light by worth per millisecond: all start with the cheapest, then the light whose next step up gains
/// most for its time takes it, as long as a step fits. Steps of one light are those of its upper hull (Sinha and
/// Zoltners 1979; for detail and rendering algorithm per object: Funkhouser and Sequin 1993).
///
/// A shared part is paid by the first light that needs it. Where many lights would pay for one together, none does
/// alone: so plans that begin with other parts paid are tried too, a few a frame.

#include <cstdint>
#include <span>
#include <vector>

#include "runtime/plan/shared_part.hpp"

namespace gnomon::plan {

/// A method of a light.
struct Option {
    double ms = 0.0;    ///< >= 0.
    double price = 0.0; ///< >= ms: with what a change to it takes.
    double worth = 0.0; ///< >= 0.
    uint32_t parts = 0; ///< Mask of those that it needs; set by Greedy.
    uint16_t method = 0;
    bool banned = false; ///< Worth nothing; only where nothing else keeps the limit.
};

class Greedy {
public:
    /// The only call that allocates.
    void reserve(uint32_t lights, uint32_t methods);

    /// A new problem, light by light. A light without options is left out.
    void begin(uint32_t methods, std::span<const SharedPart> parts) noexcept;
    void addLight() noexcept { optionCounts_[lights_++] = 0; }
    /// To the newest light.
    void add(Option option) noexcept
    {
        option.parts = needs_[option.method];
        dear_ |= option.parts;
        const uint32_t light = lights_ - 1;
        options_[size_t{light} * methods_ + optionCounts_[light]++] = option;
    }

    /// The least that a plan was found to take; without parts, the least that any takes.
    double cheapestMs() noexcept;
    /// After cheapestMs(). Where even the cheapest plan takes more than `limitMs`, that by Option::price.
    /// @param parts Mask of those to begin with, if that is better than with those of the cheapest plan.
    /// @param turn  Of the sets of parts, which `tries` ones are tried beside.
    void solve(double limitMs, uint32_t parts, uint64_t turn, uint32_t tries, std::span<uint32_t> chosen) noexcept;

    /// Masks of parts.
    uint32_t partsOf(uint32_t method) const noexcept { return needs_[method]; }
    double msOf(uint32_t parts) const noexcept;
    uint32_t partSets() const noexcept; ///< How many sets of the parts that take time there are, at most 16.

private:
    struct Upgrade {
        double perMs = 0.0; ///< Gain; 0: there is none that fits.
        double ms = 0.0;    ///< More than now, parts included.
        const Option* to = nullptr;
    };
    enum class Start : uint8_t { byTime, byPrice }; ///< By time nothing is banned.
    std::span<const Option> optionsOf(uint32_t light) const noexcept;
    const Option* cheapestOf(uint32_t light, uint32_t paid, Start start) const noexcept;
    double cheapestPaying(uint32_t paid) const noexcept;
    Upgrade upgradeOf(uint32_t light, uint32_t paid, double leftMs) const noexcept;
    double climb(Start start, uint32_t paid, double limitMs) noexcept;

    std::span<const SharedPart> parts_;
    std::vector<Option> options_; ///< Per light `methods` slots.
    std::vector<uint32_t> optionCounts_;
    std::vector<uint32_t> needs_; ///< By method, what it needs of the parts that take time.
    std::vector<const Option*> at_;
    std::vector<Upgrade> upgrades_;
    uint32_t lights_ = 0, methods_ = 0;
    uint32_t dear_ = 0, cheapest_ = 0; ///< Parts that some option needs; those of the cheapest plan.
    double cheapestMs_ = 0.0;
};

} // namespace gnomon::plan
