#pragma once
// One scene drawn by two methods that should show the same picture.
#include "device/fixture.hpp"

namespace gnomon::test {

struct MethodPair {
    Host plain, other;
    std::vector<Image8> pictures; ///< Of `other`, as of the newest differing().

    MethodPair(const char* plainMethod, const char* otherMethod, const Scene& scene, const HostOptions& options = {})
        : plain(scene, options), other(scene, options), plainMethod_(plainMethod), otherMethod_(otherMethod)
    {
        plain.pinAll(plainMethod);
        other.pinAll(otherMethod);
    }

    /// A setting that both have.
    void set(const char* setting, double value)
    {
        plain.require(gnSetMethodSetting(plain.context, plainMethod_, setting, value));
        other.require(gnSetMethodSetting(other.context, otherMethod_, setting, value));
    }

    /// Draws both. @return texels that differ.
    size_t differing(const FrameOptions& frame)
    {
        plain.require(plain.draw(frame));
        other.require(other.draw(frame));
        REQUIRE(std::string(other.decision(0).pMethod) == otherMethod_);
        pictures = other.pictures();
        return differences(plain.pictures(), pictures);
    }

private:
    const char* plainMethod_;
    const char* otherMethod_;
};

} // namespace gnomon::test
