// Structures of other versions are read and written as gnomon.h says, "Structures".
#include "runtime/base/struct_size.hpp"

#include <doctest/doctest.h>
#include <vector>

namespace gnomon {
namespace {

struct First { // as an older host was compiled with
    uint32_t structSize;
    uint32_t required;
};
struct Second { // this library's
    uint32_t structSize;
    uint32_t required;
    uint64_t added;
};
struct Third { // a newer host's
    uint32_t structSize;
    uint32_t required;
    uint64_t added, unknown;
};

} // namespace

template <>
struct StructTraits<Second> {
    static constexpr const char* name = "Second";
    static constexpr std::uint32_t smallest = sizeof(First);
};

namespace {

Error errorOf(const void* from)
{
    const Result<Second> read = readStruct<Second>(from, "pThing");
    REQUIRE_FALSE(read);
    return read.error();
}

TEST_CASE("an older host's structure is read as far as it goes, and zero after that")
{
    const First given[2] = {{sizeof(First), 7}, {9, 9}}; // the second stands for what lies behind it
    const Result<Second> read = readStruct<Second>(&given[0], "pThing");
    REQUIRE(read);
    CHECK(read->structSize == sizeof(Second));
    CHECK(read->required == 7);
    CHECK(read->added == 0);
}

TEST_CASE("a newer host's structure is read where it does not say what the library does not know")
{
    Third given{sizeof(Third), 7, 8, 0};
    const Result<Second> read = readStruct<Second>(&given, "pThing");
    REQUIRE(read);
    CHECK(read->structSize == sizeof(Second));
    CHECK(read->added == 8);
    reinterpret_cast<unsigned char*>(&given)[21] = 1;
    const Error error = errorOf(&given);
    CHECK(error.result == GN_ERROR_UNSUPPORTED);
    CHECK(error.text == "pThing: Second::structSize is 24 and byte 21 is not 0, but this library knows 16 bytes");
}

TEST_CASE("what is no size of any version is refused by name and value")
{
    std::vector<Second> given(kLargestStruct / sizeof(Second) + 1);
    for (const uint32_t size : {0u, 4u, 7u, 9u, 10u, kLargestStruct + 4, 0xCCCCCCCCu}) {
        given[0].structSize = size;
        const Error error = errorOf(given.data());
        CHECK(error.result == GN_ERROR_OUT_OF_RANGE);
        CHECK(error.text == "pThing: Second::structSize is " + std::to_string(size) +
                                ", not sizeof(Second) of any version; here it is 16");
    }
    given[0].structSize = kLargestStruct;
    CHECK(readStruct<Second>(given.data(), "pThing"));
    const Error null = errorOf(nullptr);
    CHECK(null.result == GN_ERROR_NULL_ARGUMENT);
    CHECK(null.text == "pThing is null");
}

TEST_CASE("the size of an array's elements is its stride")
{
    const auto sumOf = [](const void* first, uint32_t count) {
        uint64_t sum = 0;
        const auto* things = static_cast<const Second*>(first);
        const Result<void> read =
            readStructs(things, count, "pThings", [&](const Second& thing) { sum += thing.required + thing.added; });
        return read ? std::to_string(sum) : read.error().text;
    };
    const First older[] = {{sizeof(First), 1}, {sizeof(First), 2}, {sizeof(First), 4}};
    CHECK(sumOf(older, 3) == "7");
    Third newer[] = {{sizeof(Third), 1, 8, 0}, {sizeof(Third), 2, 16, 0}, {sizeof(Third), 4, 32, 0}};
    CHECK(sumOf(newer, 3) == "63");
    CHECK(sumOf(nullptr, 0) == "0");
    newer[1].structSize = sizeof(Second);
    CHECK(sumOf(newer, 3) == "pThings[1]: Second::structSize is 16, but that of pThings[0] is 24");
    newer[1].structSize = 0;
    CHECK(sumOf(newer, 3) == "pThings[1]: Second::structSize is 0, not sizeof(Second) of any version; here it is 16");
}

TEST_CASE("what is filled has the host's size: no byte after an older one's, zero in a newer one's")
{
    First older[3] = {{sizeof(First), 0}, {0, 0}, {9, 9}};
    const StructArray<Second> shorter(reinterpret_cast<Second*>(older), 2);
    REQUIRE(shorter.fits());
    shorter.put(0, {.required = 5, .added = 6});
    shorter.put(1, {.required = 7, .added = 8});
    CHECK(older[0].required == 5);
    CHECK(older[1].structSize == sizeof(First));
    CHECK(older[1].required == 7);
    CHECK(older[2].required == 9);

    Third newer[2] = {{sizeof(Third), 1, 1, 1}, {1, 1, 1, 1}};
    const StructArray<Second> longer(reinterpret_cast<Second*>(newer), 2);
    longer.put(1, {.required = 7, .added = 8});
    CHECK(newer[1].structSize == sizeof(Third));
    CHECK(newer[1].added == 8);
    CHECK(newer[1].unknown == 0);
    CHECK(newer[0].unknown == 1);
}

TEST_CASE("an array of no elements has no size to be looked at")
{
    Second unset{};
    const StructArray<Second> none(nullptr, 3), empty(&unset, 0);
    CHECK(none.fits());
    CHECK(none.size() == 0);
    CHECK(empty.fits());
    CHECK(empty.size() == 0);
    CHECK_FALSE(StructArray<Second>(&unset, 1).fits());
}

} // namespace
} // namespace gnomon
