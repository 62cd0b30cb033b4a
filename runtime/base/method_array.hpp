#pragma once
// A value for every method, while methods come.
#include <cstddef>
#include <vector>

namespace gnomon {

template <typename T>
class MethodArray {
public:
    /// Makes room for so many methods; those that are new have T{}.
    void grow(std::size_t methods)
    {
        if (values_.size() < methods) values_.resize(methods);
    }
    T& operator[](std::size_t method)
    {
        grow(method + 1);
        return values_[method];
    }
    const T& operator[](std::size_t method) const
    {
        static const T none{};
        return method < values_.size() ? values_[method] : none;
    }

private:
    std::vector<T> values_;
};

} // namespace gnomon
