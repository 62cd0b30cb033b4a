#include "rules_support.hpp"

using namespace gnomon::rules;
using namespace gnomon::rules::test;

namespace {

/// The antecedent as text with explicit parentheses.
std::string spelled(const Antecedent& postfix)
{
    std::vector<std::string> stack;
    for (const Clause& clause : postfix) {
        if (clause.kind == Clause::Kind::Is) {
            stack.push_back(clause.variable + "=" + clause.term);
        } else if (clause.kind == Clause::Kind::Not) {
            stack.back() = "!" + stack.back();
        } else {
            const std::string right = stack.back();
            stack.pop_back();
            stack.back() = "(" + stack.back() + (clause.kind == Clause::Kind::And ? "&" : "|") + right + ")";
        }
    }
    REQUIRE(stack.size() == 1);
    return stack[0];
}

struct Good {
    std::string_view condition;
    std::string_view meaning;
};
constexpr Good kGood[] = {
    {"x is a", "x=a"},
    {"x is a and y is b or z is c", "((x=a&y=b)|z=c)"},
    {"x is a or y is b and z is c", "(x=a|(y=b&z=c))"},
    {"(x is a or y is b) and z is c", "((x=a|y=b)&z=c)"},
    {"x is a or b and y is c", "((x=a|x=b)&y=c)"},
    {"x is a or b or c or y is d", "(((x=a|x=b)|x=c)|y=d)"},
    {"not x is a and y is b", "(!x=a&y=b)"},
    {"not (x is a and y is b)", "!(x=a&y=b)"},
    {"x is not a", "!x=a"},
    {"not not x is a", "!!x=a"},
    {"((x is a))", "x=a"},
};

struct Bad {
    std::string_view sentence;
    uint32_t column;
    std::string_view message;
};
constexpr Bad kBad[] = {
    {"", 1, "starts with 'if'"},
    {"x is a then b is good", 1, "starts with 'if'"},
    {"if x a then b is good", 6, "expected 'is', found 'a'"},
    {"if x is then b is good", 9, "expected a term, found 'then'"},
    {"if (x is a then b is good", 12, "expected ')'"},
    {"if x is a) then b is good", 10, "expected 'then'"},
    {"if x is a b is good", 11, "expected 'then'"},
    {"if x is a then", 15, "found the end"},
    {"if x is a then b is good with", 30, "weight"},
    {"if x is a then b is good with 0", 31, "weight"},
    {"if x is a then b is good with 1.5", 31, "weight"},
    {"if x is a then b is good with 0,5", 31, "found '0,5'"},
    {"if x is a then b is good with nan", 31, "weight"},
    {"if x is a then b is good with 0.5 and c is good", 35, "end of the sentence"},
    {"if x is not a or b then c is good", 15, "'is not' takes one term"},
    {"if x is a then others are bad", 16, "'others' needs"},
    {"if x is a then b is good and others are bad and others are bad", 30, "once"},
    {"if x is a then never b with 0.5", 1, "takes no weight"},
    {"if x is a then never", 21, "expected an output"},
    {"if x is a then any b", 21, "expected 'is'"},
    {"if x is a ? then b is good", 11, "expected 'then', 'and' or 'or', found '?'"},
    {"if x is a then if is good", 16, "expected an output"},
};

} // namespace

TEST_CASE("conditions mean what the grammar says")
{
    for (const Good& good : kGood) {
        CAPTURE(good.condition);
        Antecedent condition;
        DiagnosticSink sink("s");
        REQUIRE(parseCondition({good.condition}, condition, sink));
        CHECK(spelled(condition) == good.meaning);
    }
}

TEST_CASE("every faulty sentence is refused at the word at fault, and the rule stays as it was")
{
    for (const Bad& bad : kBad) {
        CAPTURE(bad.sentence);
        Rule rule;
        rule.weight = 0.25;
        DiagnosticSink sink("s");
        CHECK_FALSE(parseRule({bad.sentence}, rule, sink));
        REQUIRE(sink.all().size() == 1);
        const Diagnostic& found = sink.all()[0];
        CHECK(found.id == "R06");
        CHECK(found.column == bad.column);
        CHECK_MESSAGE(contains(found.message, bad.message), found.message);
        CHECK(rule.weight == 0.25);
        CHECK(rule.antecedent.empty());
    }
}

TEST_CASE("conclusions keep their kind, term and weight")
{
    Rule rule;
    DiagnosticSink sink("s");
    REQUIRE(parseRule({"if x is a then p is good and any soft is fair and others are bad with 0.8"}, rule, sink));
    REQUIRE(rule.consequents.size() == 3);
    CHECK(rule.consequents[0].kind == Consequent::Kind::Output);
    CHECK(rule.consequents[1].kind == Consequent::Kind::Trait);
    CHECK(rule.consequents[1].name == "soft");
    CHECK(rule.consequents[2].kind == Consequent::Kind::Others);
    CHECK(rule.consequents[2].term == "bad");
    CHECK(rule.weight == 0.8);
}

TEST_CASE("nesting and length are bounded instead of exhausting the stack")
{
    DiagnosticSink sink("s");
    Antecedent condition;
    CHECK(parseCondition({std::string(31, '(') + "x is a" + std::string(31, ')')}, condition, sink));
    CHECK_FALSE(parseCondition({std::string(40, '(') + "x is a" + std::string(40, ')')}, condition, sink));
    CHECK(contains(sink.all().back().message, "nested deeper"));
    const std::string endless(kMaxSentenceBytes + 1, '(');
    CHECK_FALSE(parseCondition({endless}, condition, sink));
    CHECK(sink.all().back().id == "R07");
}

TEST_CASE("the grammar's own words are no names")
{
    for (const std::string_view word :
         {"if", "then", "and", "or", "not", "is", "any", "others", "never", "with", "are"})
        CHECK_FALSE(isName(word));
    for (const std::string_view word : {"", "1x", "a b", "a-b", "\xc3\xa4"})
        CHECK_FALSE(isName(word));
    for (const std::string_view word : {"x", "_x1", "shadow_map", "viewerDistance", "iff"})
        CHECK(isName(word));
    CHECK_FALSE(isName(std::string(kMaxNameBytes + 1, 'a')));
}
