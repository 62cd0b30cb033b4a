#include "demo/program/gnuplot.hpp"

#include <csignal>
#include <cstdio>

#include "demo/host/vulkan.hpp"
#include "demo/io/number.hpp"
#include "demo/io/png.hpp"

namespace gnomon::demo {

std::string hexOf(const Rgb8& colour)
{
    char text[8];
    std::snprintf(text, sizeof text, "#%02x%02x%02x", colour.r, colour.g, colour.b);
    return text;
}

std::string gnuplotText(std::string_view text)
{
    std::string quoted = "'";
    for (const char c : text)
        quoted.append(c == '\'' ? 2 : 1, c);
    return quoted + "'";
}

namespace {

/// A reader that ends early makes writing fail in place of ending the program.
class NoPipeSignal {
public:
    NoPipeSignal() : before_(std::signal(SIGPIPE, SIG_IGN)) {}
    ~NoPipeSignal() { std::signal(SIGPIPE, before_); }
    NoPipeSignal(const NoPipeSignal&) = delete;
    NoPipeSignal& operator=(const NoPipeSignal&) = delete;

private:
    void (*before_)(int);
};

} // namespace

void plotCurves(const std::string& settings, const std::vector<PlotCurve>& curves, const std::string& out)
{
    std::string script =
        "set terminal pngcairo size 640,420 font 'sans,10'\nset output " + gnuplotText(out) + "\n" + settings;
    for (const PlotCurve& curve : curves) {
        script += &curve == curves.data() ? "plot " : ", ";
        script += "'-' using 1:2 with " + curve.style + " title " + gnuplotText(curve.title) + " noenhanced";
    }
    script += '\n';
    for (const PlotCurve& curve : curves) {
        for (const auto& [x, y] : curve.points) {
            appendFixed(script, x, 3);
            script += ' ';
            appendFixed(script, y, 3);
            script += '\n';
        }
        script += "e\n";
    }
    FILE* pipe = popen("gnuplot", "w"); // NOLINT: a fixed word, no input of anyone's
    if (!pipe) throw HostError("gnuplot could not be started");
    const NoPipeSignal whileWriting; // after popen(): gnuplot must not inherit it
    std::fwrite(script.data(), 1, script.size(), pipe);
    if (pclose(pipe) != 0) throw HostError("gnuplot failed; is it installed?");
    if (!isWholePng(out)) throw HostError(out + ": gnuplot left no whole picture; is the disk full?");
    std::printf("%s\n", out.c_str());
}

} // namespace gnomon::demo
