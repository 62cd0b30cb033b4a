#include "rules/engine/sentence.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "runtime/base/number_text.hpp"

namespace gnomon::rules {
namespace {

constexpr std::array<std::string_view, 12> kWords = {"if",  "then", "and", "or",     "not",   "is",
                                                     "are", "with", "any", "others", "never", "otherwise"};
constexpr uint32_t kMaxNesting = 32; ///< Of parentheses and `not`: bounds the recursion below.

bool isLetter(char c) noexcept
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}
bool isDigit(char c) noexcept
{
    return c >= '0' && c <= '9';
}
bool isSpace(char c) noexcept
{
    return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

struct Token {
    enum class Kind : uint8_t { Name, Word, Number, Open, Close, End, Bad };
    Kind kind = Kind::End;
    std::string_view text;
    std::size_t offset = 0;
};

std::size_t tokenLength(std::string_view rest) noexcept
{
    const auto lengthWhile = [rest](auto&& belongs) {
        return static_cast<std::size_t>(std::find_if_not(rest.begin(), rest.end(), belongs) - rest.begin());
    };
    if (isLetter(rest.front())) return lengthWhile([](char c) { return isLetter(c) || isDigit(c); });
    if (isDigit(rest.front()) || rest.front() == '.' || rest.front() == '-' || rest.front() == '+')
        return lengthWhile([](char c) {
            return isDigit(c) || isLetter(c) || std::string_view(".,+-").find(c) != std::string_view::npos;
        });
    return 1;
}

Token::Kind tokenKind(std::string_view text) noexcept
{
    if (text == "(") return Token::Kind::Open;
    if (text == ")") return Token::Kind::Close;
    if (isLetter(text.front())) {
        const bool reserved = std::find(kWords.begin(), kWords.end(), text) != kWords.end();
        return reserved ? Token::Kind::Word : Token::Kind::Name;
    }
    return text.size() > 1 || isDigit(text.front()) ? Token::Kind::Number : Token::Kind::Bad;
}

std::vector<Token> tokenise(std::string_view text)
{
    std::vector<Token> tokens;
    std::size_t at = 0;
    while (true) {
        while (at < text.size() && isSpace(text[at]))
            ++at;
        if (at == text.size()) break;
        const std::string_view word = text.substr(at, tokenLength(text.substr(at)));
        tokens.push_back({tokenKind(word), word, at});
        at += word.size();
    }
    tokens.push_back({Token::Kind::End, {}, text.size()});
    return tokens;
}

/// Recursive descent over the grammar in the header. The first error wins and ends the sentence.
class Parser {
public:
    Parser(const SentenceText& sentence, DiagnosticSink& sink)
        : sentence_(sentence), sink_(sink), tokens_(tokenise(sentence.text))
    {
    }

    bool sentence(Rule& rule)
    {
        return expect("if", "a rule starts with 'if'") && condition(rule.antecedent, 0) &&
               expect("then", "expected 'then', 'and' or 'or'") && conclusions(rule) && atEnd();
    }
    bool otherwise(Rule& rule) { return conclusions(rule) && atEnd(); }
    bool monotony(Monotony& out)
    {
        return either("more", "less", out.ascending) && name("a variable", out.variable, out.variableAt) &&
               expect("never", "expected 'never'") && either("raises", "lowers", out.raises) &&
               ((out.isTrait = accept("any")), name(out.isTrait ? "a trait" : "an output", out.name, out.nameAt)) &&
               atEnd();
    }
    bool conditionOnly(Antecedent& out) { return condition(out, 0) && atEnd(); }

private:
    const Token& peek(std::size_t ahead = 0) const { return tokens_[std::min(next_ + ahead, tokens_.size() - 1)]; }
    bool isWord(std::string_view word, std::size_t ahead = 0) const
    {
        return peek(ahead).kind == Token::Kind::Word && peek(ahead).text == word;
    }
    bool accept(std::string_view word)
    {
        if (!isWord(word)) return false;
        ++next_;
        return true;
    }
    SourceSpot spot(const Token& token) const { return sentence_.spotOf(token.offset); }

    bool fail(const Token& token, std::string_view what)
    {
        std::string found = token.kind == Token::Kind::End ? "the end" : inQuotes(token.text);
        sink_.error("R06", spot(token), std::string(what) + ", found " + found);
        return false;
    }
    bool expect(std::string_view word, std::string_view what) { return accept(word) || fail(peek(), what); }
    /// Behind the variable of a condition, where who thinks in numbers puts a comparison.
    bool expectIs(const std::string& variable)
    {
        if (accept("is")) return true;
        constexpr std::string_view comparisons = "<>=!";
        const Token& token = peek();
        if (token.kind != Token::Kind::Bad || comparisons.find(token.text.front()) == std::string_view::npos)
            return fail(token, "expected 'is'");
        return fail(token, "rules compare no numbers: write '" + variable + " is TERM' and say in the terms of " +
                               inQuotes(variable) + " from which number to which it holds; expected 'is'");
    }
    /// One of two words that are reserved nowhere else.
    bool either(std::string_view yes, std::string_view no, bool& out)
    {
        out = peek().text == yes;
        if (!out && peek().text != no) return fail(peek(), "expected " + inQuotes(yes) + " or " + inQuotes(no));
        ++next_;
        return true;
    }
    bool atEnd() { return peek().kind == Token::Kind::End || fail(peek(), "expected the end of the sentence"); }

    bool name(std::string_view what, std::string& out, SourceSpot& at)
    {
        const Token& token = peek();
        if (token.kind != Token::Kind::Name) return fail(token, "expected " + std::string(what));
        if (token.text.size() > kMaxNameBytes)
            return fail(token, "name longer than " + std::to_string(kMaxNameBytes) + " bytes");
        out = std::string(token.text);
        at = spot(token);
        ++next_;
        return true;
    }

    bool condition(Antecedent& out, uint32_t depth) { return chain("or", Clause::Kind::Or, out, depth); }

    /// A row of operands joined by one connective, written out as postfix: a b op c op.
    bool chain(std::string_view word, Clause::Kind kind, Antecedent& out, uint32_t depth)
    {
        const auto operand = [&] {
            return kind == Clause::Kind::Or ? chain("and", Clause::Kind::And, out, depth) : unary(out, depth);
        };
        if (!operand()) return false;
        while (accept(word)) {
            if (!operand()) return false;
            out.push_back({kind, {}, {}, {}, {}});
        }
        return true;
    }

    bool unary(Antecedent& out, uint32_t depth)
    {
        if (depth == kMaxNesting) return fail(peek(), "nested deeper than " + std::to_string(kMaxNesting));
        if (accept("not")) {
            if (!unary(out, depth + 1)) return false;
            out.push_back({Clause::Kind::Not, {}, {}, {}, {}});
            return true;
        }
        if (peek().kind != Token::Kind::Open) return isClause(out);
        ++next_;
        if (!condition(out, depth + 1)) return false;
        if (peek().kind != Token::Kind::Close) return fail(peek(), "expected ')', 'and' or 'or'");
        ++next_;
        return true;
    }

    bool isClause(Antecedent& out)
    {
        Clause clause;
        if (!name("a variable", clause.variable, clause.variableAt) || !expectIs(clause.variable)) return false;
        const bool negated = accept("not");
        if (!name("a term", clause.term, clause.termAt)) return false;
        out.push_back(clause);
        // A bare name after "or" is one more term of the same variable.
        while (isWord("or") && peek(1).kind == Token::Kind::Name && !isWord("is", 2)) {
            if (negated) return fail(peek(), "'is not' takes one term; write 'not (... is ... or ...)'");
            ++next_;
            name("a term", clause.term, clause.termAt);
            out.push_back(clause);
            out.push_back({Clause::Kind::Or, {}, {}, {}, {}});
        }
        if (negated) out.push_back({Clause::Kind::Not, {}, {}, {}, {}});
        return true;
    }

    bool conclusions(Rule& rule)
    {
        do {
            if (!conclusion(rule)) return false;
        } while (accept("and"));
        return !accept("with") || weight(rule);
    }

    bool conclusion(Rule& rule)
    {
        Consequent made;
        const Token& first = peek();
        if (accept("others")) {
            made.kind = Consequent::Kind::Others;
            made.nameAt = spot(first);
            if (!expect("are", "expected 'are'") || !name("a term", made.term, made.termAt)) return false;
        } else if (accept("never")) {
            made.kind = accept("any") ? Consequent::Kind::NeverTrait : Consequent::Kind::Never;
            if (!name(made.kind == Consequent::Kind::Never ? "an output" : "a trait", made.name, made.nameAt))
                return false;
        } else {
            made.kind = accept("any") ? Consequent::Kind::Trait : Consequent::Kind::Output;
            const std::string_view what =
                made.kind == Consequent::Kind::Trait ? "a trait" : "an output, 'any', 'others' or 'never'";
            if (!name(what, made.name, made.nameAt) || !expect("is", "expected 'is'") ||
                !name("a term", made.term, made.termAt))
                return false;
        }
        rule.consequents.push_back(std::move(made));
        return true;
    }

    bool weight(Rule& rule)
    {
        const Token& token = peek();
        const std::optional<double> value =
            token.kind == Token::Kind::Number ? parseNumber(token.text) : std::optional<double>();
        if (!value || !(*value > 0.0 && *value <= 1.0)) return fail(token, "expected a weight above 0 and at most 1");
        ++next_;
        rule.weight = *value;
        return true;
    }

    const SentenceText& sentence_;
    DiagnosticSink& sink_;
    std::vector<Token> tokens_;
    std::size_t next_ = 0;
};

bool shortEnough(const SentenceText& sentence, DiagnosticSink& sink)
{
    if (sentence.text.size() <= kMaxSentenceBytes) return true;
    sink.error("R07", sentence.spotOf(0), "sentence longer than " + std::to_string(kMaxSentenceBytes) + " bytes");
    return false;
}

/// What a grammatical sentence must still keep to.
bool sensible(const SentenceText& sentence, const Rule& rule, bool isOtherwise, DiagnosticSink& sink)
{
    const auto& list = rule.consequents;
    const auto others = [](const Consequent& c) { return c.kind == Consequent::Kind::Others; };
    const auto veto = std::find_if(list.begin(), list.end(), [](const Consequent& c) { return c.isVeto(); });
    const auto lonely = std::find_if(list.begin(), list.end(), others);
    if (veto != list.end() && isOtherwise)
        sink.error("R06", veto->nameAt, "'otherwise' cannot veto: it fires where the rules know nothing");
    else if (veto != list.end() && rule.weight != 1.0)
        sink.error("R06", sentence.spotOf(0), "a sentence with 'never' takes no weight: a veto holds or it does not");
    else if (std::count_if(list.begin(), list.end(), others) > 1)
        sink.error("R06", lonely->nameAt, "'others' may stand once in a sentence");
    else if (lonely != list.end() && list.size() == 1)
        sink.error("R06", lonely->nameAt, "'others' needs a conclusion that says which output is not meant");
    else
        return true;
    return false;
}

bool finish(const SentenceText& sentence, Rule& made, bool isOtherwise, Rule& rule, DiagnosticSink& sink)
{
    if (!sensible(sentence, made, isOtherwise, sink)) return false;
    rule.antecedent = std::move(made.antecedent);
    rule.consequents = std::move(made.consequents);
    rule.weight = made.weight;
    rule.sentence = std::string(sentence.text);
    rule.at = sentence.spotOf(0);
    return true;
}

} // namespace

bool isName(std::string_view word) noexcept
{
    if (word.empty() || word.size() > kMaxNameBytes || !isLetter(word.front())) return false;
    return std::all_of(word.begin(), word.end(), [](char c) { return isLetter(c) || isDigit(c); }) &&
           std::find(kWords.begin(), kWords.end(), word) == kWords.end();
}

bool parseRule(const SentenceText& sentence, Rule& rule, DiagnosticSink& sink)
{
    Rule made;
    return shortEnough(sentence, sink) && Parser(sentence, sink).sentence(made) &&
           finish(sentence, made, false, rule, sink);
}

bool parseOtherwise(const SentenceText& sentence, Rule& rule, DiagnosticSink& sink)
{
    Rule made;
    return shortEnough(sentence, sink) && Parser(sentence, sink).otherwise(made) &&
           finish(sentence, made, true, rule, sink);
}

bool parseMonotony(const SentenceText& sentence, Monotony& promise, DiagnosticSink& sink)
{
    Monotony made;
    if (!shortEnough(sentence, sink) || !Parser(sentence, sink).monotony(made)) return false;
    made.sentence = std::string(sentence.text);
    promise = std::move(made);
    return true;
}

bool parseCondition(const SentenceText& sentence, Antecedent& condition, DiagnosticSink& sink)
{
    Antecedent made;
    if (!shortEnough(sentence, sink) || !Parser(sentence, sink).conditionOnly(made)) return false;
    condition = std::move(made);
    return true;
}

} // namespace gnomon::rules
