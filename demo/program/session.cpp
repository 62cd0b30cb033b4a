#include "demo/program/session.hpp"

#include <charconv>
#include <chrono>
#include <cstdlib>

#include "demo/io/file.hpp"
#include "demo/io/number.hpp"
#include "demo/scene/scene_file.hpp"
#ifdef GNOMON_WITH_YAML
#include "rules/engine/diagnostic.hpp"
#include "rules/yaml/shipped.hpp"
#endif

namespace gnomon::demo {
namespace {

/// A GPU that has idled may be slow at first. On an H100, where frames followed seconds of the CPU alone (a truth), the
/// median of cube_map's GPU time was 5.6 and 5.9 times what a frame grew by at least (colonnade, bunny), over 20 pairs
/// of frames, some 0.1 s. Several times that; chosen, not measured.
constexpr std::chrono::milliseconds kWakeTime{1000};

std::unique_ptr<Scene> load(const SessionOptions& options)
{
    auto scene = std::make_unique<Scene>(valueOf(loadScene(options.scene)));
    if (options.lights) limitLights(*scene, *options.lights);
    return scene;
}

// At least the default, so that lights which come and go keep their place; at most what the lighting pass takes.
uint32_t layersFor(const Scene& scene, const SessionOptions& options)
{
    if (options.maxLights > 0) return options.maxLights;
    return std::max<uint32_t>(1, static_cast<uint32_t>(scene.lights.size()));
}

VkExtent2D sizeOf(const Scene& scene, const SessionOptions& options)
{
    return options.size.width > 0 ? options.size : VkExtent2D{scene.width, scene.height};
}

ShadowHostOptions shadowOptions(const Scene& scene, const SessionOptions& options)
{
    return {.framesInFlight = options.framesInFlight,
            .viewCount = options.viewCount,
            .maxLights = layersFor(scene, options),
            .flags = options.contextFlags,
            .memoryLimit = options.memoryLimit,
            .pinnedThreads = options.pinnedThreads,
            .plugins = options.plugins};
}

RendererOptions rendererOptions(const Scene& scene, const SessionOptions& options)
{
    return {.framesInFlight = options.framesInFlight,
            .viewCount = options.viewCount,
            .maxLights = layersFor(scene, options),
            .extent = sizeOf(scene, options)};
}

bool parseUnsigned(std::string_view text, uint32_t low, uint32_t high, uint32_t& value)
{
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc() && end == text.data() + text.size() && value >= low && value <= high;
}

} // namespace

SessionOptions sessionOptions(const RunOptions& options)
{
    SessionOptions session{.scene = options.scene,
                           .framesInFlight = options.framesInFlight,
                           .validation = options.validation,
                           .knowledge = options.knowledge,
                           .plugins = options.plugins};
    if (!options.size.empty()) session.size = valueOf(parseSize(options.size));
    if (options.lights > 0) session.lights = options.lights;
    return session;
}

Session::Session(const SessionOptions& options)
    : ownScene(load(options)),
      ownDevice(Device::create({.validation = options.validation, .instanceExtensions = options.instanceExtensions})),
      scene(*ownScene), device(*ownDevice), geometry(device, scene),
      shadows(device, scene, geometry, shadowOptions(scene, options)),
      renderer(device, scene, geometry, rendererOptions(scene, options))
{
    expect(loadKnowledge(shadows, options.knowledge));
}

Session::Session(Device& sharedDevice, const Scene& sharedScene, const SessionOptions& options)
    : scene(sharedScene), device(sharedDevice), geometry(device, scene),
      shadows(device, scene, geometry, shadowOptions(scene, options)),
      renderer(device, scene, geometry, rendererOptions(scene, options))
{
    expect(loadKnowledge(shadows, options.knowledge));
}

void Session::wakeDevice(double time)
{
    if (device.properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU) return;
    const CameraState from = camera(time);
    const auto end = std::chrono::steady_clock::now() + kWakeTime;
    while (std::chrono::steady_clock::now() < end) // frame after frame, none waited for
        renderer.draw({.time = time, .cameras = {&from, 1}});
    renderer.waitForFrame();
}

Outcome<VkExtent2D> parseSize(const std::string& text)
{
    constexpr uint32_t largest = 16384; // the side every desktop device takes for 2D images
    const size_t cross = text.find('x');
    VkExtent2D size{};
    if (cross == std::string::npos || !parseUnsigned(std::string_view(text).substr(0, cross), 1, largest, size.width) ||
        !parseUnsigned(std::string_view(text).substr(cross + 1), 1, largest, size.height))
        return Outcome<VkExtent2D>::failure("'" + text + "' is no size like 1280x720 with sides from 1 to 16384");
    return size;
}

std::vector<std::string> parseNames(const std::string& text)
{
    std::vector<std::string> names;
    std::stringstream stream(text);
    for (std::string item; std::getline(stream, item, ',');)
        if (const std::string_view name = trimmed(item); !name.empty()) names.emplace_back(name);
    return names;
}

Outcome<std::vector<uint32_t>> parseCounts(const std::string& text, uint32_t low, uint32_t high)
{
    std::vector<uint32_t> counts;
    for (const std::string& word : parseNames(text)) {
        uint32_t value = 0;
        if (!parseUnsigned(word, low, high, value))
            return Outcome<std::vector<uint32_t>>::failure("'" + word + "' in '" + text + "' is no whole number from " +
                                                           std::to_string(low) + " to " + std::to_string(high));
        counts.push_back(value);
    }
    return counts;
}

std::string shippedRuleNames()
{
#ifdef GNOMON_WITH_YAML
    std::string names;
    for (const rules::ShippedRuleBase& base : rules::shippedRuleBases())
        names += (names.empty() ? "" : ", ") + std::string(base.name);
    return names;
#else
    return "none";
#endif
}

std::pair<std::string, std::string> splitPreset(const std::string& rules)
{
    std::error_code ignored; // unreadable counts as absent
    const size_t colon = rules.rfind(':');
    if (colon == std::string::npos || std::filesystem::is_regular_file(rules, ignored)) return {rules, {}};
    return {rules.substr(0, colon), rules.substr(colon + 1)};
}

Outcome<RuleText> findRules(const std::string& nameOrPath)
{
    const auto [wanted, preset] = splitPreset(nameOrPath.empty() ? "default" : nameOrPath);
    std::error_code ignored; // unreadable counts as absent; the message below names it
    if (std::filesystem::is_regular_file(wanted, ignored)) {
        Outcome<std::string> text = readText(wanted);
        return text ? Outcome<RuleText>(RuleText{std::move(*text), wanted, preset})
                    : Outcome<RuleText>::failure(text.error());
    }
#ifdef GNOMON_WITH_YAML
    for (const rules::ShippedRuleBase& base : rules::shippedRuleBases())
        if (base.name == wanted) return RuleText{std::string(base.text), wanted, preset};
    std::vector<std::string_view> known;
    for (const rules::ShippedRuleBase& base : rules::shippedRuleBases())
        known.push_back(base.name);
    return Outcome<RuleText>::failure("no rule base '" + wanted + "', and no such file" +
                                      rules::suggestion(wanted, known));
#else
    if (nameOrPath.empty()) return RuleText{};
    return Outcome<RuleText>::failure(wanted + ": this build reads no rule bases (GNOMON_WITH_YAML is off)");
#endif
}

Outcome<std::filesystem::path> findKnowledge(const std::string& nameOrPath)
{
    namespace fs = std::filesystem;
    std::error_code ignored; // unreadable counts as absent; the message below names it
    if (fs::is_regular_file(nameOrPath, ignored)) return fs::path(nameOrPath);
    std::vector<fs::path> folders;
    if (const char* data = std::getenv("GNOMON_DATA_DIR"); data != nullptr && *data != '\0')
        folders.push_back(fs::path(data) / "rules" / "knowledge");
    const fs::path executable = fs::read_symlink("/proc/self/exe", ignored); // empty where there is no /proc
    if (!executable.empty())
        folders.push_back(executable.parent_path() / ".." / "share" / "gnomon" / "rules" / "knowledge");
    folders.emplace_back(GNOMON_SOURCE_KNOWLEDGE);
    for (const fs::path& folder : folders)
        if (const fs::path file = folder / (nameOrPath + ".csv"); fs::is_regular_file(file, ignored))
            return file.lexically_normal();
    return Outcome<fs::path>::failure("no knowledge base '" + nameOrPath + "': neither a file nor a shipped one");
}

Status loadKnowledge(const ShadowHost& shadows, const std::string& nameOrPath)
{
    if (nameOrPath.empty()) return Done{};
    const Outcome<std::filesystem::path> file = findKnowledge(nameOrPath);
    if (!file) return Status::failure(file.error());
    const Outcome<std::string> text = readText(*file);
    if (!text) return Status::failure(text.error());
    return shadows.loadKnowledge(*text, file->string());
}

void requireSilence(const Device& device)
{
    const std::vector<std::string> messages = device.validation.messages();
    if (messages.empty()) return;
    std::string all = std::to_string(messages.size()) + " validation messages:";
    for (const std::string& message : messages)
        all += "\n" + message;
    throw HostError(all);
}

} // namespace gnomon::demo
