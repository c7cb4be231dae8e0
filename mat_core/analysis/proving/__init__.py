"""Whether what an axis states of its errors is true: bounds by signs and sizes of polynomials, nothing sampled."""
