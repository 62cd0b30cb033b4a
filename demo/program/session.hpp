#pragma once
// What every command that draws needs: a scene, a device, the renderer and gnomon, made in order and destroyed in
// reverse.

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "demo/host/renderer.hpp"
#include "demo/program/commands.hpp"
#include "demo/scene/scene.hpp"

namespace gnomon::demo {

struct SessionOptions {
    std::string scene;              ///< Path or shipped name.
    VkExtent2D size{};              ///< Zero: the scene's.
    std::optional<uint32_t> lights; ///< limitLights().
    uint32_t maxLights = 0;         ///< At a time; 0: all the scene has.
    uint32_t framesInFlight = 2;
    uint32_t viewCount = 1;
    GnContextCreateFlags contextFlags = 0;
    VkDeviceSize memoryLimit = 0; ///< As ShadowHostOptions', as the next.
    bool pinnedThreads = false;
    bool validation = false;
    std::string knowledge; ///< loadKnowledge().
    std::vector<const char*> instanceExtensions;
    std::vector<std::string> plugins; ///< ShadowHostOptions::plugins.
};

/// Those that `gnomon run` is given, with or without a window; throws HostError if a size is none.
SessionOptions sessionOptions(const RunOptions& options);

struct Session {
    explicit Session(const SessionOptions& options);
    /// On a device and a scene that outlive the session: bench makes many contexts on one device.
    Session(Device& device, const Scene& scene, const SessionOptions& options);

    std::unique_ptr<Scene> ownScene;
    std::unique_ptr<Device> ownDevice;
    const Scene& scene;
    Device& device;
    SceneGeometry geometry;
    ShadowHost shadows;
    Renderer renderer;

    CameraState camera(double time) const { return cameraAt(scene, time); }

    /// Before anything is timed: keeps a GPU busy until its clock is up. Does nothing on a CPU.
    void wakeDevice(double time);
};

/// "1280x720" as an extent; fails naming what is wrong. Sides in [1, 16384].
Outcome<VkExtent2D> parseSize(const std::string& text);

/// "1,2,4" as numbers in [low, high].
Outcome<std::vector<uint32_t>> parseCounts(const std::string& text, uint32_t low, uint32_t high);

/// Comma-separated words, without the blanks round them.
std::vector<std::string> parseNames(const std::string& text);

/// "default, quality, ..."; "none" in a build that reads no rule bases.
std::string shippedRuleNames();

struct RuleText {
    std::string text;
    std::string name;   ///< For messages: the path, or "default". Empty: there are no rules.
    std::string preset; ///< One of the text's; empty: none.

    /// As findRules() takes it.
    std::string label() const { return preset.empty() ? name : name + ':' + preset; }
};
/// "my.yaml:low" as base and preset; a file of the whole name comes first.
std::pair<std::string, std::string> splitPreset(const std::string& rules);

/// A rule base by path or by the name of a shipped one, either with ":PRESET" behind it; empty: "default", or none in a
/// build that reads none.
Outcome<RuleText> findRules(const std::string& nameOrPath);

/// A knowledge base by path, or by the name of a shipped one: `lavapipe`, `h100`.
Outcome<std::filesystem::path> findKnowledge(const std::string& nameOrPath);
/// Teaches the cost model; an empty name leaves it what the library brings.
Status loadKnowledge(const ShadowHost& shadows, const std::string& nameOrPath);

/// Throws HostError listing what validation found.
void requireSilence(const Device& device);

} // namespace gnomon::demo
