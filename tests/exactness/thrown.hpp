#pragma once
// Frames of a scene whose cameras, times and lights are thrown, drawn by one method and by ray_traced, and the pixels
// that differ.
#include <cstdint>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "demo/program/session.hpp"
#include "exactness/stage.hpp"

namespace gnomon::exact {

class Dice {
public:
    explicit Dice(unsigned seed) : random_(seed) {}
    double between(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
    glm::dvec3 direction(); ///< Unit.

private:
    std::mt19937 random_;
};

struct Throw {
    demo::CameraState eye;
    double time = 0.0; ///< Seconds, in [0, 8].
    std::vector<demo::Light> lights;
};

enum class Lights : uint8_t {
    thrown,   ///< Anew for every frame, away from where they are first. None is static.
    asTheyAre ///< Static or on their way, as the scene has them.
};

class Thrown {
public:
    Thrown(Scene from, VkExtent2D extent, Lights lights = Lights::thrown);

    /// \param most So many lights are present, in turn; the others are not.
    Throw next(Dice& dice, std::size_t most = 32);
    /// The method serves every light that is present, or the test fails.
    Pictures draw(const char* method, const Throw& frame);
    std::uint64_t rays() const;                        ///< Of the newest frame.
    std::size_t passes(const std::string& part) const; ///< Of the newest frame: passes with this in their name.

    const Scene& scene() const { return scene_; }
    demo::Session& session() { return session_; }

private:
    demo::CameraState camera(Dice& dice) const;
    void throwLights(Dice& dice, std::vector<demo::Light>& lights) const;
    void keepPresent(std::size_t most, Throw& frame);

    Scene scene_;
    std::vector<demo::Light> first_;
    Lights lights_;
    std::size_t turn_ = 0; ///< Lights that were present so far, in all frames.
    demo::Session session_;
    std::set<std::string> warm_;
};

struct Apart {
    std::size_t pixels = 0; ///< That differ.
    std::size_t clear = 0;  ///< Of these: that have one answer only (ambiguousPixels()).
    std::size_t dark = 0, all = 0;
};
std::string inWords(const Apart& apart);

/// Adds what differs in the newest frame, for which `shown` was read.
void compareWith(Thrown& thrown, const Throw& frame, const Pictures& truth, const Pictures& shown, Apart& apart);

} // namespace gnomon::exact
