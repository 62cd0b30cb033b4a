#pragma once
#include <string>

namespace gnomon::test {

/// Sets a locale whose decimal point is a comma, in C and in C++, until the end of its life. Made by hand, since a
/// build machine may have no locale but "C".
class CommaLocale {
public:
    CommaLocale();
    ~CommaLocale();
    bool inForce() const; ///< printf writes a comma.

private:
    std::string folder_;
};

} // namespace gnomon::test
