// `gnomon why`: questions to the log of a run, no device needed.
#include <cstdio>

#include "demo/io/file.hpp"
#include "demo/program/commands.hpp"
#include "demo/program/decision_log.hpp"
#include "demo/program/session.hpp"

namespace gnomon::demo {

int whyCommand(const WhyOptions& options)
{
    std::error_code ignored; // unreadable: readText names it
    if (std::filesystem::file_size(options.log, ignored) > kMaxDecisionLogBytes && !ignored)
        throw HostError(options.log + ": larger than 16 MiB, no decision log");
    const std::string bytes = valueOf(readText(options.log));
    WhyQuestion question{.frame = options.frame, .light = options.light, .method = options.method};
    if (!options.method.empty()) question.asked = Asked::whyNot;
    if (options.whatIf) question.asked = Asked::whatIf;
    if (options.changed) question.asked = Asked::changed;
    if (options.sinceSwitch) question.asked = Asked::changedSinceSwitch;
    const Outcome<std::string> text = answerFromLog(bytes, question);
    if (!text) throw HostError(options.log + ": " + text.error());
    std::printf("%s", text->c_str());
    return 0;
}

} // namespace gnomon::demo
