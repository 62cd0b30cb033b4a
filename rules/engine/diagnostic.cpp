#include "rules/engine/diagnostic.hpp"

namespace gnomon::rules {

std::string quoted(std::string_view text)
{
    std::string result(1, '\'');
    result += text;
    result += '\'';
    return result;
}

std::string toText(const Diagnostic& diagnostic)
{
    std::string text = diagnostic.file;
    if (diagnostic.line != 0) text += ':' + std::to_string(diagnostic.line) + ':' + std::to_string(diagnostic.column);
    text += diagnostic.severity == Severity::Error ? ": error " : ": warning ";
    return text + diagnostic.id + ": " + diagnostic.message;
}

} // namespace gnomon::rules
