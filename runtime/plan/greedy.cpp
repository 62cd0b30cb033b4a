#include "runtime/plan/greedy.hpp"

#include <algorithm>
#include <bit>
#include <limits>

namespace gnomon::plan {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// What costs next to nothing is taken first, whatever it gains.
constexpr double kLeastMs = 1e-9;

} // namespace

void Greedy::reserve(uint32_t lights, uint32_t methods)
{
    options_.resize(std::max(options_.size(), size_t{lights} * methods));
    optionCounts_.resize(std::max<size_t>(optionCounts_.size(), lights));
    needs_.resize(std::max<size_t>(needs_.size(), methods));
    at_.resize(optionCounts_.size());
    upgrades_.resize(optionCounts_.size());
}

void Greedy::begin(uint32_t methods, std::span<const SharedPart> parts) noexcept
{
    lights_ = 0;
    methods_ = methods;
    parts_ = parts;
    dear_ = cheapest_ = 0;
    std::fill_n(needs_.begin(), methods, 0);
    for (size_t p = 0; p < parts.size(); ++p)
        for (const uint32_t method : parts[p].methods)
            if (method < methods && parts[p].ms > 0.0) needs_[method] |= 1u << p;
}

std::span<const Option> Greedy::optionsOf(uint32_t light) const noexcept
{
    return std::span(options_).subspan(size_t{light} * methods_, optionCounts_[light]);
}

double Greedy::msOf(uint32_t parts) const noexcept
{
    double sum = 0.0;
    for (; parts; parts &= parts - 1)
        sum += parts_[static_cast<size_t>(std::countr_zero(parts))].ms;
    return sum;
}

uint32_t Greedy::partSets() const noexcept
{
    return 1u << std::min(std::popcount(dear_), 4);
}

/// Of those that need nothing but `paid`; of equals the one worth most.
const Option* Greedy::cheapestOf(uint32_t light, uint32_t paid, Start start) const noexcept
{
    const Option* best = nullptr;
    const auto better = [&](const Option& a, const Option& b) {
        if (start == Start::byPrice && a.banned != b.banned) return b.banned;
        const double own = start == Start::byPrice ? a.price : a.ms, other = start == Start::byPrice ? b.price : b.ms;
        return own != other ? own < other : a.worth > b.worth;
    };
    for (const Option& option : optionsOf(light))
        if (!(option.parts & ~paid) && (!best || better(option, *best))) best = &option;
    return best;
}

/// Infinite where a light is left without any.
double Greedy::cheapestPaying(uint32_t paid) const noexcept
{
    double sum = msOf(paid);
    for (uint32_t light = 0; light < lights_; ++light)
        if (optionCounts_[light] > 0) {
            const Option* option = cheapestOf(light, paid, Start::byTime);
            sum += option ? option->ms : kInfinity;
        }
    return sum;
}

/// Beginning with all parts, and with none, one is dropped or added as long as that saves.
double Greedy::cheapestMs() noexcept
{
    cheapestMs_ = kInfinity;
    for (uint32_t paid : {dear_, 0u}) {
        double least = cheapestPaying(paid);
        for (uint32_t untried = dear_; untried;) {
            const uint32_t part = untried & -untried;
            const double ms = cheapestPaying(paid ^ part);
            untried = ms < least ? dear_ & ~part : untried & ~part;
            if (ms < least) least = ms, paid ^= part;
        }
        if (least < cheapestMs_) cheapestMs_ = least, cheapest_ = paid;
        if (dear_ == 0) break;
    }
    return cheapestMs_;
}

/// The best gain per millisecond of what fits.
Greedy::Upgrade Greedy::upgradeOf(uint32_t light, uint32_t paid, double leftMs) const noexcept
{
    Upgrade best;
    const Option* const from = at_[light];
    if (!from) return best;
    for (const Option& to : optionsOf(light)) {
        const double gain = to.worth - from->worth;
        if (!(gain > 0.0)) continue;
        const uint32_t missing = to.parts & ~paid;
        const double ms = to.price - from->price + (missing ? msOf(missing) : 0.0);
        if (ms > leftMs) continue;
        const double perMs = gain / std::max(ms, kLeastMs);
        if (perMs > best.perMs) best = {perMs, ms, &to};
    }
    return best;
}

/// @return what the plan that at_ then holds is worth; < 0 where it does not fit.
double Greedy::climb(Start start, uint32_t paid, double limitMs) noexcept
{
    double leftMs = limitMs - msOf(paid);
    for (uint32_t light = 0; light < lights_; ++light) {
        at_[light] = cheapestOf(light, paid, start);
        if (!at_[light] && optionCounts_[light] > 0) return -1.0;
        if (at_[light]) leftMs -= at_[light]->price;
    }
    const auto room = [&] { return std::max(leftMs, 0.0); }; // what saves time fits always
    for (bool all = true;;) {
        for (uint32_t light = 0; light < lights_ && all; ++light)
            upgrades_[light] = upgradeOf(light, paid, room());
        all = false;
        const auto next = std::max_element(upgrades_.begin(), upgrades_.begin() + lights_,
                                           [](const Upgrade& a, const Upgrade& b) { return a.perMs < b.perMs; });
        if (next == upgrades_.begin() + lights_ || !next->to) {
            uint32_t used = 0; // what was paid in vain is free again
            for (uint32_t light = 0; light < lights_; ++light)
                used |= at_[light] ? at_[light]->parts : 0;
            if (used == paid) break;
            leftMs += msOf(paid & ~used);
            paid = used;
            all = true;
            continue;
        }
        const auto light = static_cast<uint32_t>(next - upgrades_.begin());
        if (next->ms <= room()) {
            all = (next->to->parts & ~paid) != 0; // others go along for less
            paid |= next->to->parts;
            leftMs -= next->ms;
            at_[light] = next->to;
        }
        if (!all) *next = upgradeOf(light, paid, room());
    }
    double worth = 0.0;
    for (uint32_t light = 0; light < lights_; ++light)
        worth += at_[light] ? at_[light]->worth : 0.0;
    return leftMs < 0.0 ? -1.0 : worth;
}

void Greedy::solve(double limitMs, uint32_t parts, uint64_t turn, uint32_t tries, std::span<uint32_t> chosen) noexcept
{
    const auto take = [&] {
        for (uint32_t light = 0; light < lights_; ++light)
            chosen[light] = at_[light] ? at_[light]->method : kNone;
    };
    double best = climb(Start::byPrice, cheapest_, limitMs);
    if (best < 0.0 && cheapestMs_ <= limitMs) climb(Start::byTime, cheapest_, limitMs);
    take();
    const auto tryPaying = [&](uint32_t paid) {
        if (paid == cheapest_) return;
        const double worth = climb(Start::byPrice, paid, limitMs);
        if (worth > best) best = worth, take();
    };
    if (dear_ == 0) return;
    tryPaying(parts & dear_);
    for (; tries > 0; --tries, ++turn) {
        uint32_t set = 0; // the bits of `turn`, one to a part
        uint64_t bits = turn;
        for (uint32_t rest = dear_; rest; rest &= rest - 1, bits >>= 1)
            if (bits & 1) set |= rest & -rest;
        tryPaying(set);
    }
}

} // namespace gnomon::plan
