#pragma once
// Rule bases that favour one method, so that a test says when a light's method changes.
#include <cmath>

#include "device/fixture.hpp"

namespace gnomon::test {

constexpr uint32_t kFadeFrames = 4;

/// Methods that serve a spot light, with a map so coarse that its picture differs from an exact one's.
class FadeHost : public Host {
public:
    explicit FadeHost(Scene wanted = smallScene(), const HostOptions& options = {}) : Host(std::move(wanted), options)
    {
        require(gnSetMethodSetting(context, "shadow_map", "resolution", 64));
    }
};

/// From now on every light has `method`; a change fades over `frames`.
inline void favour(Host& host, const char* method, uint32_t frames = kFadeFrames, const std::string& policy = {},
                   const char* allocation = "none")
{
    const std::string text = std::string("version: 1\n"
                                         "variables: {lightRadius: {universe: [0, 2], unit: m, terms: "
                                         "{all: [-.inf, -.inf, .inf, .inf]}}}\n"
                                         "options: {allocation: ") +
                             allocation + "}\nrules: [{rule: if lightRadius is all then " + method +
                             " is favoured}]\n"
                             "policy: {hysteresis: {crossFadeFrames: " +
                             std::to_string(frames) + "}" + policy + "}\n";
    host.warm(method);
    host.require(gnLoadRules(host.context, text.data(), text.size(), method));
}

/// What is shown while `outgoing` and `incoming` are mixed: the largest distance from the exact mix, in steps of R8.
inline double worstMix(const Image8& shown, const Image8& outgoing, const Image8& incoming, double share)
{
    REQUIRE(shown.texels.size() == outgoing.texels.size());
    REQUIRE(shown.texels.size() == incoming.texels.size());
    double worst = 0.0;
    for (size_t i = 0; i < shown.texels.size(); ++i) {
        const double exact = outgoing.texels[i] * (1.0 - share) + incoming.texels[i] * share;
        worst = std::max(worst, std::abs(shown.texels[i] - exact));
    }
    return worst;
}

/// Pictures of a method alone, by a pin, which shows at once.
inline std::vector<Image8> alone(Host& host, const char* method, const FrameOptions& options = {}, uint32_t view = 0)
{
    host.pinAll(method);
    host.require(host.draw(options));
    return host.pictures(view);
}

} // namespace gnomon::test
