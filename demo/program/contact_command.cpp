// The contact sheet: a band per scene, its methods three a row; the whole picture, and beside it the place with the
// largest error pixel for pixel, once as it looks and once with the wrong pixels marked.
#include <algorithm>
#include <cstdio>

#include "demo/io/number.hpp"
#include "demo/io/png.hpp"
#include "demo/io/text.hpp"
#include "demo/program/checks.hpp"
#include "demo/program/commands.hpp"
#include "demo/program/measure.hpp"
#include "demo/program/pictures.hpp"
#include "demo/program/progress.hpp"
#include "demo/scene/scene_file.hpp"

namespace gnomon::demo {
namespace {

constexpr uint32_t kOverviewWidth = 256, kOverviewHeight = 144;
constexpr uint32_t kCropSize = 144; // as high as the overview: 1:1 pixels
constexpr uint32_t kGap = 4;
constexpr uint32_t kMethodsPerRow = 3; // 1 684 pixels: a README page shows it near 1:1
constexpr uint32_t kCellWidth = kOverviewWidth + 2 * (kCropSize + kGap) + 2 * kGap;
constexpr Rgb8 kPaper{24, 24, 28}, kInk{235, 235, 235};

/// Rows of a caption, and of a cell with its caption.
uint32_t captionHeight()
{
    return measureText("X").height + kGap;
}
uint32_t cellHeight()
{
    return kOverviewHeight + captionHeight() + 2 * kGap;
}

struct MarkedFrame {
    ErrorCount errors;
    Rect worst{0, 0, kCropSize, kCropSize};
    Image8 marked; ///< The picture with the wrong pixels of all lights in colour.
};

MarkedFrame markErrors(const Session& session, const Truth& truth, const Image8& picture,
                       const std::vector<Image8>& visibility)
{
    MarkedFrame out;
    out.marked = picture;
    uint64_t most = 0;
    const SceneState& state = session.renderer.state();
    for (size_t layer = 0; layer < state.present.size(); ++layer) {
        const std::vector<uint8_t>* counted = nullptr;
        const Image8* expected = truth.find(session.scene.lights[state.present[layer]].name, &counted);
        if (!expected) continue;
        out.errors += compare(visibility[layer], *expected, *counted);
        uint64_t inside = 0;
        const Rect window = worstWindow(visibility[layer], *expected, *counted, kCropSize, kCropSize, inside);
        if (inside >= most) {
            most = inside;
            out.worst = window;
        }
        for (size_t i = 0; i < counted->size(); ++i) {
            const bool lit = visibility[layer].texels[i] >= 128, shouldBeLit = expected->texels[i] >= 128;
            if ((*counted)[i] != 1 || lit == shouldBeLit) continue;
            const Rgb8 colour = lit ? kFalseLit : kFalseShadow;
            uint8_t* texel = &out.marked.texels[i * 3];
            texel[0] = colour.r;
            texel[1] = colour.g;
            texel[2] = colour.b;
        }
    }
    return out;
}

struct Cell {
    Image8& sheet;
    int32_t x, y;
    std::string caption;
};

void drawCell(const Cell& cell, const Image8& picture, const MarkedFrame& frame)
{
    const auto& [sheet, x, y, caption] = cell;
    drawText(sheet, x, y, caption, kInk);
    const int32_t top = y + int32_t(captionHeight());
    blit(sheet, x, top, shrinkToFit(picture, kOverviewWidth, kOverviewHeight));
    const double scale = std::min(double(kOverviewWidth) / picture.width, double(kOverviewHeight) / picture.height);
    if (scale < 1.0)
        outline(sheet,
                {x + int32_t(frame.worst.x * scale), top + int32_t(frame.worst.y * scale),
                 uint32_t(frame.worst.width * scale), uint32_t(frame.worst.height * scale)},
                {255, 220, 0});
    blit(sheet, x + int32_t(kOverviewWidth + kGap), top, crop(picture, frame.worst));
    blit(sheet, x + int32_t(kOverviewWidth + 2 * kGap + kCropSize), top, crop(frame.marked, frame.worst));
}

/// \pre settle()
void drawMethod(Cell cell, Session& session, const Truth& truth)
{
    const Image8 picture = session.renderer.readColour();
    const MarkedFrame frame = markErrors(session, truth, picture, session.renderer.readVisibility());
    cell.caption += "  wrong ";
    appendFixed(cell.caption, frame.errors.percent(frame.errors.wrong()), 4);
    cell.caption += " %, " + std::to_string(session.renderer.state().present.size()) + " lights";
    drawCell(cell, picture, frame);
    std::printf("%s\n", cell.caption.c_str());
    std::fflush(stdout);
}

std::vector<std::string> methodNames(Device& device, const Scene& scene, const std::vector<std::string>& wanted)
{
    Session session(device, scene, {.scene = {}, .size = {16, 16}});
    std::vector<std::string> names;
    for (const GnMethodInfo& info : session.shadows.methods())
        if (!info.pUnavailable &&
            (wanted.empty() || std::find(wanted.begin(), wanted.end(), info.pName) != wanted.end()))
            names.push_back(info.pName);
    return names;
}

} // namespace

int contactCommand(const ContactOptions& options)
{
    const std::vector<std::string> wanted = parseNames(options.methods);
    requireMethods(wanted);
    const std::vector<SettingChoice> choices = requireChoices(options.settings, wanted);
    requireRanges(choices, wanted);
    requireScenes(options.scenes);
    requireWritable(options.out);
    const bool asked = !wanted.empty();
    bool drawn = false;
    const std::unique_ptr<Device> device = Device::create({});
    std::vector<std::string> scenes = options.scenes;
    if (scenes.empty())
        for (const ShippedScene& shipped : shippedScenes())
            scenes.push_back(shipped.name);
    std::vector<std::string> methods;
    Image8 sheet;
    uint32_t bandRows = 1;
    Progress progress(static_cast<uint32_t>(scenes.size()));
    for (size_t row = 0; row < scenes.size(); ++row) {
        Scene scene = valueOf(loadScene(scenes[row]));
        setSourceSizes(scene, options.sources);
        if (methods.empty()) {
            methods = methodNames(*device, scene, wanted);
            if (methods.empty()) throw HostError("none of the methods asked for is in this build");
            bandRows = (static_cast<uint32_t>(methods.size()) + kMethodsPerRow - 1) / kMethodsPerRow;
            sheet = Image8(kMethodsPerRow * kCellWidth + kGap,
                           static_cast<uint32_t>(scenes.size()) * bandRows * cellHeight() + kGap, 3);
            fill(sheet, {0, 0, sheet.width, sheet.height}, kPaper);
        }
        const VkExtent2D size =
            options.size.empty() ? VkExtent2D{scene.width, scene.height} : valueOf(parseSize(options.size));
        const double time = frameTime(scene, scene.frames / 2); // motion under way, every light of the middle there
        const std::optional<Truth> truth = measureTruth(*device, scene, size, time);
        if (!truth)
            throw HostError(std::string("a contact sheet needs the method ") + kTruthMethod +
                            ", which this build lacks");
        for (size_t column = 0; column < methods.size(); ++column) {
            const int32_t x = int32_t(column % kMethodsPerRow * kCellWidth + kGap);
            const int32_t y = int32_t((row * bandRows + column / kMethodsPerRow) * cellHeight() + kGap);
            Session probe(*device, scene, {.scene = {}, .size = {16, 16}});
            const GnMethodInfo info = infoOf(probe.shadows, methods[column]);
            const Scene served = onlyServed(scene, info.traits);
            const std::string caption = scenes[row] + "  " + methods[column] + textOf(info, choices);
            if (lightCountAt(served, time, false) == 0) {
                const bool serves = !served.lights.empty();
                drawText(sheet, x, y,
                         caption + (serves ? ": none of its lights is there" : ": serves none of its lights"), kInk);
                if (asked)
                    std::fprintf(stderr, "note: %s: %s is left out: %s\n", scenes[row].c_str(), methods[column].c_str(),
                                 serves ? "none of its lights is there" : "it serves none of the lights");
                continue;
            }
            try {
                Session session(*device, served, {.scene = {}, .size = size});
                setChoices(session.shadows, methods[column], choices);
                expect(session.shadows.pinAll(methods[column]));
                settle(session, methods[column], time, false);
                drawMethod({sheet, x, y, caption}, session, *truth);
                drawn = true;
            } catch (const HostError& error) { // one method must not end a long sheet
                drawText(sheet, x, y, caption + ": does not serve all of the lights", kInk);
                noteLeftOut(scenes[row], methods[column], error);
            }
        }
        progress.show(static_cast<uint32_t>(row + 1), scenes[row]);
    }
    if (!drawn) throw HostError("none of the methods asked for serves a light that is there: no sheet is written");
    expect(writePng(options.out, sheet));
    std::printf("%s: %ux%u; red is lit by mistake, blue is dark by mistake, crops are 1:1\n", options.out.c_str(),
                sheet.width, sheet.height);
    return 0;
}

} // namespace gnomon::demo
