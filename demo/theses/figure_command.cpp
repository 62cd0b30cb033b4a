// The figures of Rautenbach 2008, chapter 4, with our methods and times: milliseconds over lights and faces.
#include <algorithm>
#include <array>
#include <cstdio>

#include "demo/host/pin_thread.hpp"
#include "demo/io/csv.hpp"
#include "demo/program/checks.hpp"
#include "demo/program/gnuplot.hpp"
#include "demo/program/measure.hpp"
#include "demo/scene/primitives.hpp"
#include "demo/scene/scene_file.hpp"
#include "demo/theses/commands.hpp"

namespace gnomon::demo {
namespace {

struct Figure {
    const char* name; ///< The thesis's number.
    const char* title;
    std::array<const char*, 7> methods; ///< Ends with the first null.
    bool still;                         ///< The model stands still.
};

constexpr std::array kFigures = {
    Figure{"4.6", "stencil volumes", {"stencil_volume"}, false},
    Figure{"4.19", "shadow maps", {"shadow_map"}, false},
    Figure{"4.22", "McCool: volumes from a depth map", {"mccool"}, false},
    Figure{"4.26", "Chan and Durand", {"chan_durand"}, false},
    Figure{"4.30", "Thakur: angular spans", {"angular_spans"}, false},
    Figure{"4.35", "octree of static volumes, nothing moves", {"octree_volume", "stencil_volume"}, true},
    Figure{"4.40",
           "all methods of the thesis, 1 638 faces",
           {"stencil_volume", "shadow_map", "mccool", "chan_durand", "angular_spans", "octree_volume"},
           false},
};

/// The thesis's models by their face counts, and one beyond: ring and tube segments of a torus.
struct Model {
    uint32_t ring, tube;
    uint32_t faces() const { return 2 * ring * tube; }
};
constexpr std::array<Model, 4> kModels = {{{20, 15}, {39, 21}, {151, 32}, {250, 200}}};
constexpr Model kMiddleModel = {39, 21}; // 1 638: what the thesis compares methods on
constexpr std::array<uint32_t, 5> kLights = {1, 2, 4, 8, 16};

struct Curve {
    std::string method;
    Model model;
    std::array<double, kLights.size()> milliseconds{};
};

Scene roomWith(const Scene& room, const Model& model, uint32_t lights, bool still)
{
    Scene scene = room;
    for (Instance& instance : scene.instances) {
        if (instance.name != "model") continue;
        Mesh& mesh = scene.meshes[instance.mesh];
        const std::string name = mesh.name;
        mesh = makeTorus({.radius = 1.6f, .tube = 0.6f, .ringSegments = model.ring, .tubeSegments = model.tube});
        mesh.name = name;
        if (!still) continue;
        instance.spin = {};
        instance.isStatic = true;
    }
    limitLights(scene, lights);
    return scene;
}

double increment(Device& device, const Scene& scene, const std::string& method, VkExtent2D size, uint32_t repeat)
{
    Session session(device, scene, {.scene = {}, .size = size, .pinnedThreads = true});
    expect(session.shadows.pinAll(method));
    settle(session, method, frameTime(scene, 0), false);
    const PairTimes times = timePairs(session, repeat, false, nullptr);
    return minimum(times.withMs) - minimum(times.withoutMs);
}

Curve measure(Device& device, const Scene& room, const std::string& method, const Model& model, bool still,
              const FigureOptions& options)
{
    Curve curve{.method = method, .model = model};
    const VkExtent2D size =
        options.size.empty() ? VkExtent2D{room.width, room.height} : valueOf(parseSize(options.size));
    for (size_t i = 0; i < kLights.size(); ++i) {
        const Scene scene = roomWith(room, model, kLights[i], still);
        curve.milliseconds[i] = increment(device, scene, method, size, options.repeat);
        std::printf("%-16s %6u faces %2u lights %9.3f ms\n", method.c_str(), model.faces(), kLights[i],
                    curve.milliseconds[i]);
        std::fflush(stdout);
    }
    return curve;
}

CsvWriter table(const Figure& figure, const std::vector<Curve>& curves)
{
    CsvWriter csv({"figure", "method", "faces", "lights", "increment_ms_min"});
    for (const Curve& curve : curves)
        for (size_t i = 0; i < kLights.size(); ++i) {
            csv.cell(figure.name).cell(curve.method).cell(curve.model.faces()).cell(kLights[i]);
            csv.cell(curve.milliseconds[i], 3).endRow();
        }
    return csv;
}

/// The method's colour; where a figure has several models, the darker the more faces.
Rgb8 colourOf(const Curve& curve, bool shaded)
{
    const Rgb8 colour = methodColour(curve.method);
    if (!shaded) return colour;
    const auto place = std::find_if(kModels.begin(), kModels.end(),
                                    [&](const Model& model) { return model.faces() == curve.model.faces(); });
    const auto percent = static_cast<uint32_t>(100 - 20 * (place - kModels.begin()));
    const auto shade = [percent](uint8_t channel) { return static_cast<uint8_t>(channel * percent / 100); };
    return {shade(colour.r), shade(colour.g), shade(colour.b)};
}

void plot(const Figure& figure, bool still, const std::vector<Curve>& curves, const std::string& out)
{
    const std::string settings =
        std::string("set title 'figure ") + figure.name + ": " + figure.title +
        (still && !figure.still ? ", nothing moves" : "") +
        "'\nset xlabel 'lights'\nset ylabel 'ms a frame'\nset logscale x 2\nset xrange [0.9:18]\nset yrange [0:]\n"
        "set xtics (1,2,4,8,16)\nset grid\nset key left top\n";
    const bool shaded = std::any_of(curves.begin(), curves.end(), [&](const Curve& curve) {
        return curve.model.faces() != curves.front().model.faces();
    });
    std::vector<PlotCurve> plotted;
    for (const Curve& curve : curves) {
        plotted.push_back({.title = curve.method + ' ' + std::to_string(curve.model.faces()) + " faces",
                           .style = "linespoints lw 2 pt 7 lc rgb '" + hexOf(colourOf(curve, shaded)) + "'"});
        for (size_t i = 0; i < kLights.size(); ++i)
            plotted.back().points.emplace_back(kLights[i], curve.milliseconds[i]);
    }
    plotCurves(settings, plotted, out);
}

} // namespace

int figureCommand(const FigureOptions& options)
{
    const auto found = std::find_if(kFigures.begin(), kFigures.end(),
                                    [&](const Figure& figure) { return options.figure == figure.name; });
    if (found == kFigures.end()) {
        std::string known;
        for (const Figure& figure : kFigures)
            known += std::string(known.empty() ? "" : ", ") + figure.name;
        throw HostError("no figure '" + options.figure + "'; there are " + known);
    }
    requireWritable(options.csv);
    requireWritable(options.out);
    requireGnuplot(options.out);
    const std::unique_ptr<Device> device = Device::create({});
    pinThread(0);
    const Scene room = valueOf(loadScene("views/cube_room"));
    const bool still = found->still || options.still;
    std::vector<Curve> curves;
    size_t methods = 0;
    while (methods < found->methods.size() && found->methods[methods])
        ++methods;
    for (size_t m = 0; m < methods; ++m) {
        if (methods > 2)
            curves.push_back(measure(*device, room, found->methods[m], kMiddleModel, still, options));
        else
            for (const Model& model : kModels)
                curves.push_back(measure(*device, room, found->methods[m], model, still, options));
    }
    const CsvWriter csv = table(*found, curves);
    if (options.csv.empty())
        std::printf("%s", csv.text().c_str());
    else
        expect(csv.save(options.csv));
    if (!options.out.empty()) plot(*found, still, curves, options.out);
    return 0;
}

} // namespace gnomon::demo
