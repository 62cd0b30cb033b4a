#pragma once

/// log2 and exp2 from + - * / and bit patterns alone: libm's differ between machines, and so would decisions.
/// Correct to 4e-16 relative (exp2) and 3e-16 absolute plus rounding (log2) in the default rounding mode.

namespace gnomon::cost {

/// NaN for NaN and negative numbers, -inf for 0, inf for inf. Subnormal numbers count as 0.
double log2Exactly(double x) noexcept;

/// 0 below 2^-1022, inf from 2^1024 on, NaN for NaN.
double exp2Exactly(double x) noexcept;

} // namespace gnomon::cost
