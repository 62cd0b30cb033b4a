#pragma once
// Bad input: a code of its own, a sentence that names the value, and a next frame as if nothing had been.
#include "device/fixture.hpp"

namespace gnomon::test {

/// A host whose good picture is known.
struct Watched {
    explicit Watched(Scene scene = smallScene(), const HostOptions& options = {}) : host(std::move(scene), options)
    {
        host.pinAll("shadow_map");
        host.draw(2, {});
        good = host.pictures();
        REQUIRE(dark(good[0]) > 100);
        REQUIRE(lit(good[0]) > 100);
    }

    /// The call failed as it should, and the error says why; the next frame is the good one.
    void refused(const std::string& what, GnResult result, GnResult expected, const char* named)
    {
        CAPTURE(what);
        CHECK_MESSAGE(result == expected, std::string(gnResultName(result))
                                              << " instead of " << std::string(gnResultName(expected)));
        CHECK_MESSAGE(host.lastError().find(named) != std::string::npos,
                      "'" << host.lastError() << "' does not name " << std::string(named));
        bool reported = false;
        for (const std::string& message : host.takeMessages())
            reported = reported || message.find(named) != std::string::npos;
        CHECK(reported);
        host.require(host.draw());
        CHECK(differences(host.pictures(), good) == 0);
    }

    Host host;
    std::vector<Image8> good;
};

} // namespace gnomon::test
