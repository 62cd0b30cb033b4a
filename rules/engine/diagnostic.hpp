#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace gnomon::rules {

/// A place in a text, both counted from 1; 0 where the text is not known. Columns count bytes.
struct SourceSpot {
    uint32_t line = 0;
    uint32_t column = 0;

    friend constexpr bool operator==(const SourceSpot&, const SourceSpot&) = default;
};

enum class Severity : uint8_t {
    Warning, ///< The rule base works, but probably not as its author means it.
    Error,   ///< The rule base is refused; whatever was in force before stays in force.
};

/// One finding about a rule base. The id is stable and listed in rules/README.md: R.. for the text, L.. for its
/// meaning.
struct Diagnostic {
    std::string id;
    Severity severity = Severity::Error;
    std::string file;
    uint32_t line = 0;
    uint32_t column = 0;
    std::string message;
};

/// 'text', as names appear in messages. Not called quoted(), which would find std::quoted() for a std::string.
std::string inQuotes(std::string_view text);

/// What to say behind an unknown name: "; did you mean 'near'?" where one of those there are differs by a slip of the
/// hand (a letter added, left out, changed, or two swapped; in long names two of them), and a list of them where it is
/// short or no name is near.
std::string suggestion(std::string_view name, std::span<const std::string_view> known);

/// "file:line:column: error: message [L01]", the form compilers use and editors jump to.
std::string toText(const Diagnostic& diagnostic);

/// Collects findings about one file.
class DiagnosticSink {
public:
    explicit DiagnosticSink(std::string_view file) : file_(file) {}

    void error(std::string_view id, SourceSpot at, std::string message)
    {
        add(id, Severity::Error, at, std::move(message));
        ++errors_;
    }
    void warning(std::string_view id, SourceSpot at, std::string message)
    {
        add(id, Severity::Warning, at, std::move(message));
    }

    uint32_t errorCount() const noexcept { return errors_; }
    const std::vector<Diagnostic>& all() const noexcept { return list_; }
    std::vector<Diagnostic> take() noexcept { return std::move(list_); }

private:
    void add(std::string_view id, Severity severity, SourceSpot at, std::string message)
    {
        list_.push_back({std::string(id), severity, file_, at.line, at.column, std::move(message)});
    }

    std::string file_;
    std::vector<Diagnostic> list_;
    uint32_t errors_ = 0;
};

} // namespace gnomon::rules
