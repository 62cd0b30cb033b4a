// Sections about moments of a run: pictures with and without methods, the worst frames, how to see it again.
#include <algorithm>
#include <filesystem>

#include "demo/io/file.hpp"
#include "demo/io/png.hpp"
#include "demo/program/decision_log.hpp"
#include "demo/report/markup.hpp"
#include "demo/report/sections.hpp"

namespace gnomon::demo {

namespace {

constexpr size_t kMostPictures = 3;
constexpr size_t kMostPictureBytes = 1'200'000; // with all else the page stays under 2 MB
constexpr uint32_t kPictureWidth = 640, kPictureHeight = 480;
constexpr size_t kMostMoments = 5;

/// The picture as a PNG file of at most kPictureWidth x kPictureHeight, through a file beside the page's own.
Outcome<std::string> smallPng(const std::filesystem::path& file)
{
    const Outcome<Image8> image = readPng(file, 3);
    if (!image) return Outcome<std::string>::failure(image.error());
    if (image->width <= kPictureWidth && image->height <= kPictureHeight) return readText(file);
    return encodePng(shrinkToFit(*image, kPictureWidth, kPictureHeight));
}

std::string dataUrl(const std::string& png)
{
    return "data:image/png;base64," + base64(png);
}

/// First, middle and last of those there are.
std::vector<uint32_t> chosen(const std::vector<uint32_t>& frames)
{
    if (frames.size() <= kMostPictures) return frames;
    return {frames[frames.size() / 2], frames.front(), frames.back()};
}

/// The light to ask about: one that got another method in this frame, or the one measured costliest. None where no
/// light had a method.
const LightTrack* lightOf(const RunData& run, uint32_t frame)
{
    const LightTrack* best = nullptr;
    double most = -1.0;
    for (const LightTrack& light : run.lights)
        for (const Stretch& stretch : light.stretches) {
            if (frame < stretch.first || frame > stretch.last || run.methods[stretch.method] == "none") continue;
            const bool changed = stretch.first == frame && frame != run.frames.front().frame;
            const double ms = changed ? 1e30 : stretch.timed > 0 ? stretch.measuredMs / stretch.timed : 0.0;
            if (ms > most) best = &light, most = ms;
        }
    return best;
}

std::string momentText(const RunData& run, const FrameRow& row)
{
    std::string out = "<h3>Frame " + std::to_string(row.frame) + ": " + fixed(row.frameMs, 1) + " ms, shadows " +
                      fixed(row.gpuMs + row.cpuMs, 1) + " ms, " + std::to_string(row.switches) +
                      " change(s) of method</h3>\n";
    const LightTrack* light = lightOf(run, row.frame);
    if (!light || run.log.empty()) return out;
    const Outcome<std::string> why =
        answerFromLog(run.log, {.asked = Asked::why, .frame = row.frame, .light = light->name, .method = {}});
    return out + "<pre>" + escaped(why ? *why : why.error()) + "</pre>\n";
}

} // namespace

std::string pictureSection(const RunData& run)
{
    std::string out;
    size_t bytes = 0;
    for (const uint32_t frame : chosen(run.pictures)) {
        const std::string name = (run.folder / pictureName(frame)).string();
        const Outcome<std::string> plain = smallPng(name + ".png"), methods = smallPng(name + "_methods.png");
        if (!plain || !methods) {
            out += "<p class=\"note\">" + escaped(plain ? methods.error() : plain.error()) + "</p>\n";
            continue;
        }
        bytes += (plain->size() + methods->size()) * 4 / 3;
        if (bytes > kMostPictureBytes) break;
        out +=
            "<figure><div class=\"slide\"><img alt=\"frame\" src=\"" + dataUrl(*plain) +
            "\"/><img alt=\"the same with each light's method\" class=\"over\" src=\"" + dataUrl(*methods) +
            "\"/><input type=\"range\" min=\"0\" max=\"100\" value=\"50\" aria-label=\"how much of the picture names "
            "methods\" "
            "oninput=\"this.parentNode.style.setProperty('--cut',this.value+'%')\"/></div><figcaption>Frame " +
            std::to_string(frame) + "; drag to uncover each light's method.</figcaption></figure>\n";
    }
    return out.empty() ? out : "<section><h2>Pictures</h2>\n" + out + "</section>\n";
}

std::string worstSection(const RunData& run)
{
    if (run.frames.empty()) return {};
    std::vector<const FrameRow*> rows;
    for (const FrameRow& row : run.frames)
        rows.push_back(&row);
    const size_t count = std::min(kMostMoments, rows.size());
    std::partial_sort(rows.begin(), rows.begin() + std::ptrdiff_t(count), rows.end(),
                      [](const FrameRow* a, const FrameRow* b) { return a->frameMs > b->frameMs; });
    std::string out = "<section><h2>The longest frames</h2>\n";
    for (size_t i = 0; i < count; ++i)
        out += momentText(run, *rows[i]);
    return out + "</section>\n";
}

std::string reproduceSection(std::span<const std::string> commands, std::span<const std::string> notes)
{
    std::string out = "<section><h2>See it again</h2><pre>";
    for (const std::string& line : commands)
        out += escaped(line) + "\n";
    out += "</pre>\n";
    for (const std::string& note : notes)
        out += "<p class=\"note\">" + escaped(note) + "</p>\n";
    return out + "</section>\n";
}

} // namespace gnomon::demo
