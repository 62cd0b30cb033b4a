// Why each pixel is lit or dark: the reason codes of a hybrid method as colours over the picture, and how many pixels
// each reason decided, rightly and wrongly.
#include <algorithm>
#include <array>
#include <cstdio>

#include "demo/io/csv.hpp"
#include "demo/io/png.hpp"
#include "demo/program/checks.hpp"
#include "demo/program/measure.hpp"
#include "demo/program/setting_choices.hpp"
#include "demo/scene/scene_file.hpp"
#include "demo/theses/commands.hpp"
#include "shaders/hybrid/reasons.h"

namespace gnomon::demo {
namespace {

struct Reason {
    const char* name;
    Rgb8 colour;
    bool lit; ///< What such a pixel shows.
};

// Lit reasons are bright and dark ones dim, each pair of one hue: texels blue, neighbours green, rays orange.
constexpr std::array<Reason, gpu::REASON_COUNT> kReasons = {{{"unknown", {255, 0, 255}, true},
                                                             {"outside", {200, 200, 200}, true},
                                                             {"backfacing", {60, 60, 60}, false},
                                                             {"map_lit", {110, 190, 255}, true},
                                                             {"map_shadow", {20, 50, 130}, false},
                                                             {"tc_lit", {110, 190, 255}, true},
                                                             {"tc_shadow", {20, 50, 130}, false},
                                                             {"nb_confirmed", {0, 90, 60}, false},
                                                             {"nb_corrected", {0, 170, 60}, false},
                                                             {"ag_confirmed", {110, 110, 0}, false},
                                                             {"rt_lit", {255, 170, 40}, true},
                                                             {"rt_shadow", {170, 60, 0}, false},
                                                             {"fallback_lit", {255, 120, 200}, true},
                                                             {"tile_lit", {150, 230, 170}, true},
                                                             {"tile_shadow", {10, 80, 90}, false}}};

struct Tally {
    uint64_t pixels = 0, falseLit = 0, falseShadow = 0;
};
using Tallies = std::array<Tally, kReasons.size()>;

size_t reasonAt(const Image8& codes, size_t pixel)
{
    const size_t code = codes.texels[pixel];
    if (code == 255) return gpu::REASON_OUTSIDE; // outside the light's rectangle: cleared, not drawn
    return code < kReasons.size() ? code : 0;
}

void tally(const Image8& codes, const Image8& truth, const std::vector<uint8_t>& counted, Tallies& out)
{
    for (size_t i = 0; i < codes.texels.size(); ++i) {
        const size_t reason = reasonAt(codes, i);
        Tally& entry = out[reason];
        ++entry.pixels;
        const bool lit = kReasons[reason].lit, shouldBeLit = truth.texels[i] >= 128;
        if (counted[i] != 1 || lit == shouldBeLit) continue;
        ++(lit ? entry.falseLit : entry.falseShadow);
    }
}

/// A third picture, two thirds reason.
void colourBy(const Image8& codes, Image8& picture)
{
    for (size_t i = 0; i < codes.texels.size(); ++i) {
        const Rgb8 colour = kReasons[reasonAt(codes, i)].colour;
        const uint8_t channels[3] = {colour.r, colour.g, colour.b};
        for (size_t c = 0; c < 3; ++c) {
            uint8_t& texel = picture.texels[3 * i + c];
            texel = static_cast<uint8_t>((texel + 2u * channels[c]) / 3u);
        }
    }
}

void setAll(Session& session, const std::string& method, const std::vector<SettingChoice>& choices, bool reasons)
{
    for (const SettingChoice& choice : choices)
        expect(session.shadows.set(method, choice.name, choice.value));
    expect(session.shadows.set(method, "reasons", reasons ? 1.0 : 0.0));
}

void print(const Tallies& tallies, const std::string& scene, const std::string& method, uint64_t pixels)
{
    CsvWriter csv({"scene", "method", "reason", "pixels", "percent", "false_lit", "false_shadow"});
    for (size_t i = 0; i < kReasons.size(); ++i) {
        const Tally& entry = tallies[i];
        if (entry.pixels == 0) continue;
        csv.cell(scene).cell(method).cell(kReasons[i].name).cell(entry.pixels);
        csv.cell(100.0 * double(entry.pixels) / double(pixels), 3).cell(entry.falseLit).cell(entry.falseShadow);
        csv.endRow();
    }
    std::printf("%s", csv.text().c_str());
}

} // namespace

int reasonsCommand(const ReasonsOptions& options)
{
    requireMethods({options.method});
    requireSetting(options.method, "reasons");
    const std::vector<SettingChoice> choices = requireChoices(options.settings, {options.method});
    requireRanges(choices, {options.method});
    requireWritable(options.out);
    Scene scene = valueOf(loadScene(options.scene));
    const VkExtent2D size =
        options.size.empty() ? VkExtent2D{scene.width, scene.height} : valueOf(parseSize(options.size));
    const uint32_t frame = options.frame.value_or(scene.frames / 2);
    if (frame >= scene.frames)
        throw HostError("--frame " + std::to_string(frame) + ": scene '" + scene.name + "' has frames 0 to " +
                        std::to_string(scene.frames - 1));
    const double time = frameTime(scene, frame);
    if (!options.light.empty()) keepLights(scene, {options.light});
    if (scene.lights.empty()) throw HostError("scene '" + options.scene + "' has no light");
    if (lightCountAt(scene, time, false) == 0) throw HostError("no light is there in frame " + std::to_string(frame));
    const std::unique_ptr<Device> device = Device::create({});

    const std::optional<Truth> truth = measureTruth(*device, scene, size, time);
    if (!truth)
        throw HostError(std::string("reasons are held against the method ") + kTruthMethod +
                        ", which this build lacks");
    Session session(*device, scene, {.scene = {}, .size = size});
    expect(session.shadows.pinAll(options.method));
    setAll(session, options.method, choices, false);
    settle(session, options.method, time, false);
    Image8 picture = session.renderer.readColour();
    setAll(session, options.method, choices, true);
    settle(session, options.method, time, false);
    const std::vector<Image8> codes = session.renderer.readVisibility();

    Tallies tallies{};
    for (size_t layer = 0; layer < codes.size(); ++layer) {
        const std::vector<uint8_t>* counted = nullptr;
        const Image8* expected = truth->find(scene.lights[session.renderer.state().present[layer]].name, &counted);
        if (expected) tally(codes[layer], *expected, *counted, tallies);
    }
    print(tallies, scene.name, options.method, codes.size() * uint64_t(size.width) * size.height);
    if (options.out.empty()) return 0;
    colourBy(codes.front(), picture);
    expect(writePng(options.out, picture));
    std::printf("%s: %ux%u, the first light's\n", options.out.c_str(), picture.width, picture.height);
    return 0;
}

} // namespace gnomon::demo
