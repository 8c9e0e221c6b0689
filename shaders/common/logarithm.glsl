// log and exp near their zeros, where drivers lose relative accuracy: lavapipe's log is good to 1.6e-7 of 1, no better.
#ifndef SAMPLERSCOPE_LOGARITHM
#define SAMPLERSCOPE_LOGARITHM

// log(1 + x) for x > -1. For |x| <= 1/2, as 2 artanh(x/(2 + x)): the series is in z^2 <= 1/9, cut at 1e-9.
float log_one_plus(float x) {
    float z = x / (2.0 + x);
    float t = z * z;
    float series = 1.0 + t * (0.333333333333333 + t * (0.2 + t * (0.142857142857143 + t * (0.111111111111111
        + t * (0.0909090909090909 + t * (0.0769230769230769 + t * 0.0666666666666667))))));
    return abs(x) <= 0.5 ? 2.0 * z * series : log(1.0 + x);
}

// exp(x) - 1 for x >= 0. Below 1/2 by its series, cut at 1e-9 of the value.
float exp_minus_one(float x) {
    float series = 1.0 + x * (0.5 + x * (0.166666666666667 + x * (0.0416666666666667 + x * (0.00833333333333333
        + x * (0.00138888888888889 + x * (0.000198412698412698 + x * 2.48015873015873e-5))))));
    return x < 0.5 ? x * series : exp(x) - 1.0;
}

#endif
