// gnomon_host_bench: what a stranger's deferred renderer sees of gnomon, frame by frame. `--help` lists the options.
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <stdexcept>
#include <string>
#include <string_view>

#include "runs.hpp"

namespace {
using namespace stranger;

constexpr const char* kHelp =
    R"(gnomon_host_bench: gnomon in a small deferred renderer, six circling point lights, open meshes
  --entry submitted|recorded  gnSubmitShadows() or gnCmdRenderShadows(); submitted
  --method NAME|default|all   pins all lights; `all` runs every method that can serve, one after another; default
  --frames N                  60
  --size WxH                  1280x720
  --budget MS                 GnFrameInfo::budgetMs; 0
  --rules FILE                a rule base; the shipped "default"
  --knowledge FILE            gnLoadKnowledge(); none
  --hooks 0|1                 device memory from the host (GnContextCreateInfo::pfnAllocateMemory), whose blocks are
                              counted; 0
  --warm 0|1                  gnWarmUp() before the first frame; 1
  --explain 0|1               gnExplain() of the first frame, of the last one, and where a light switches; 0
  --wrong 0|1                 the share of wrong pixels against ray_traced, at three moments after the frames; 0
  --why-not NAME              gnExplain() of the last frame: why light 0 does not have this method
  --csv FILE                  a line a frame
  --picture FILE              the last frame as PNG
Columns: shadow is the host's own measurement (timestamps around the shadows and, recorded, the call), gnomon what
gnGetFrameStats() says. A budget is held against both.
)";

struct Arguments {
    Options options;
    std::string method = "default", csvPath, picturePath, whyNot;
    int frames = 60;
    bool warm = true, explain = false, wrong = false;
};

int number(const std::string& text)
{
    size_t used = 0;
    const int value = std::stoi(text, &used);
    if (used != text.size() || value < 0) throw std::invalid_argument(text);
    return value;
}

void setOption(Arguments& arguments, std::string_view name, const std::string& value)
{
    Options& options = arguments.options;
    if (name == "--entry" && (value == "submitted" || value == "recorded")) {
        options.recorded = value == "recorded";
    } else if (name == "--size") {
        const size_t cross = value.find('x');
        if (cross == std::string::npos) throw std::invalid_argument(value);
        options.size = {static_cast<uint32_t>(number(value.substr(0, cross))),
                        static_cast<uint32_t>(number(value.substr(cross + 1)))};
    } else if (name == "--method") {
        arguments.method = value;
    } else if (name == "--frames") {
        arguments.frames = number(value);
    } else if (name == "--budget") {
        options.budgetMs = std::stof(value);
    } else if (name == "--rules") {
        options.rulesPath = value;
    } else if (name == "--knowledge") {
        options.knowledgePath = value;
    } else if (name == "--hooks") {
        options.hooks = number(value) != 0;
    } else if (name == "--warm") {
        arguments.warm = number(value) != 0;
    } else if (name == "--explain") {
        arguments.explain = number(value) != 0;
    } else if (name == "--wrong") {
        arguments.wrong = number(value) != 0;
    } else if (name == "--why-not") {
        arguments.whyNot = value;
    } else if (name == "--csv") {
        arguments.csvPath = value;
    } else if (name == "--picture") {
        arguments.picturePath = value;
    } else {
        throw std::invalid_argument(std::string(name) + " " + value);
    }
}

Arguments parse(int argc, char** argv)
{
    Arguments arguments;
    for (int i = 1; i < argc; i += 2) {
        if (i + 1 == argc) throw std::invalid_argument(argv[i]);
        setOption(arguments, argv[i], argv[i + 1]);
    }
    return arguments;
}

void printFrame(size_t frame, const FrameReport& report)
{
    std::printf("frame %3zu  shadow %8.2f  gnomon %8.2f  predicted %8.2f  call %8.2f  wall %8.2f ms  %s\n", frame,
                report.shadowMs, report.gnomonMs, report.predictedMs, report.callMs, report.wallMs,
                listChoices(report.choices).c_str());
}

void explainSwitches(const Renderer& renderer, bool always)
{
    const auto& choices = renderer.reports().back().choices;
    for (int light = 0; light < kLampCount; ++light) {
        if (!always && !choices[static_cast<size_t>(light)].switched) continue;
        std::printf("-- light %d, frame %zu\n%s\n", light, renderer.reports().size(),
                    renderer.shadows().explain(light, nullptr).c_str());
        return; // the others say much the same
    }
}

void printPart(const char* name, const std::vector<FrameReport>& reports, size_t first, size_t last)
{
    std::vector<double> shadow, gnomon, wall;
    for (size_t i = first; i < last; ++i) {
        shadow.push_back(reports[i].shadowMs);
        wall.push_back(reports[i].wallMs);
        if (reports[i].gnomonMs > 0.0) gnomon.push_back(reports[i].gnomonMs);
    }
    std::printf("%s, %zu frames (mean, median, max):", name, last - first);
    for (const auto& [label, values] : {std::pair{"shadow", &shadow}, {"gnomon", &gnomon}, {"wall", &wall}}) {
        const Summary summary = summarise(*values);
        std::printf("  %s %.2f %.2f %.2f", label, summary.mean, summary.median, summary.max);
    }
    std::printf(" ms\n");
}

/// Index of the first frame that began a second or later after the first one.
size_t steadyFrom(const std::vector<FrameReport>& reports)
{
    double elapsedMs = 0.0;
    size_t frame = 0;
    while (frame < reports.size() && elapsedMs < 1000.0)
        elapsedMs += reports[frame++].wallMs;
    return frame;
}

void writeCsv(const std::string& path, const std::vector<FrameReport>& reports)
{
    std::ofstream file(path);
    file << "frame,shadow_ms,gnomon_ms,predicted_ms,call_ms,wall_ms,choices\n";
    for (size_t i = 0; i < reports.size(); ++i)
        file << i + 1 << ',' << reports[i].shadowMs << ',' << reports[i].gnomonMs << ',' << reports[i].predictedMs
             << ',' << reports[i].callMs << ',' << reports[i].wallMs << ",\"" << listChoices(reports[i].choices)
             << "\"\n";
    if (!file) throw std::runtime_error(path + ": cannot be written");
}

void runOne(const Device& device, const Arguments& arguments, const std::string& method)
{
    Renderer renderer(device, arguments.options);
    if (method != "default" && !renderer.shadows().pin(method.c_str())) {
        std::printf("%s: cannot serve\n", method.c_str());
        return;
    }
    if (arguments.warm) renderer.shadows().warmUp();
    for (int frame = 0; frame < arguments.frames; ++frame) {
        renderer.renderFrame(frame * kStepS);
        if (arguments.explain) explainSwitches(renderer, frame == 0 || frame + 1 == arguments.frames);
    }
    renderer.finish();
    if (!arguments.whyNot.empty())
        std::printf("-- light 0, not %s\n%s\n", arguments.whyNot.c_str(),
                    renderer.shadows().explain(0, arguments.whyNot.c_str()).c_str());
    const auto& reports = renderer.reports();
    for (size_t i = 0; i < reports.size(); ++i)
        printFrame(i + 1, reports[i]);
    const size_t steady = steadyFrom(reports);
    std::printf("%s, %s, %s, %ux%u\n", arguments.options.recorded ? "recorded" : "submitted", method.c_str(),
                device.name, arguments.options.size.width, arguments.options.size.height);
    printPart("first frame", reports, 0, 1);
    printPart("first second", reports, 0, steady);
    printPart("steady", reports, steady, reports.size());
    if (arguments.options.hooks) {
        const size_t blocks = renderer.shadows().blocksGiven();
        std::printf("memory: %zu blocks from the host\n", blocks);
        if (blocks == 0) throw std::runtime_error("the host was not asked for memory");
    }
    if (!arguments.csvPath.empty()) writeCsv(arguments.csvPath, reports);
    if (!arguments.picturePath.empty()) writePicture(renderer.read(), arguments.picturePath);
    if (arguments.wrong)
        std::printf("wrong: %.3f %%\n", wrongAtMoments(renderer, traceReferences(device, arguments.options.size)));
}

} // namespace

int main(int argc, char** argv)
{
    if (argc == 2 && std::string_view(argv[1]) == "--help") return std::fputs(kHelp, stdout) < 0;
    try {
        const Arguments arguments = parse(argc, argv);
        const Device device;
        if (!device.present()) {
            std::puts("skipped: no Vulkan device");
            return 77;
        }
        if (arguments.method != "all") {
            runOne(device, arguments, arguments.method);
            return 0;
        }
        runOne(device, arguments, "default");
        for (const std::string& method : Renderer(device, arguments.options).shadows().methods())
            runOne(device, arguments, method);
        return 0;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "gnomon_host_bench: %s\n", error.what());
        return 1;
    }
}
