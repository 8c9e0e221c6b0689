// Sine, cosine, arc functions, exp, log and pow in double precision, which GLSL has only for float. Good to a few float64
// ulp (tests/shaders). A file widened to double calls these in place of the built-in functions of the same name.
// Reductions and coefficients are those of fdlibm (Sun Microsystems, 1993). `precise` keeps the compiler from cancelling
// a sum against its own parts, which is how rounding errors are found here.
#ifndef SAMPLERSCOPE_DOUBLE
#define SAMPLERSCOPE_DOUBLE

const double DOUBLE_PI = 3.14159265358979323846lf;
const double DOUBLE_HALF_PI = 1.57079632679489661923lf;
const double DOUBLE_HALF_PI_LOW = 6.12323399573676603587e-17lf;
const double DOUBLE_LN2_HIGH = 6.93147180369123816490e-01lf; // 33 bits, so that a multiple up to 2^20 of it is exact
const double DOUBLE_LN2_LOW = 1.90821492927058770002e-10lf;
const double DOUBLE_LN2 = 0.693147180559945309417lf;
const double DOUBLE_INV_LN2 = 1.44269504088896340736lf;

double double_from_words(uint low, uint high) { return packDouble2x32(uvec2(low, high)); }
double double_nan() { return double_from_words(0u, 0x7ff80000u); }
double double_infinity() { return double_from_words(0u, 0x7ff00000u); }

// 2^k for -1022 <= k <= 1023.
double double_power_of_two(int k) { return double_from_words(0u, uint(k + 1023) << 20u); }

// Bits of x below the upper 26 of its significand set to 0: products of two such numbers are exact.
double double_head(double x) {
    uvec2 words = unpackDouble2x32(x);
    return packDouble2x32(uvec2(words.x & 0xf8000000u, words.y));
}

// The rounding error of the product p = a b (Dekker); the driver's fma is not fused.
double double_product_error(double a, double b, double p) {
    double ah = double_head(a), bh = double_head(b);
    precise double al = a - ah, bl = b - bh;
    precise double error = ((ah * bh - p) + ah * bl + al * bh) + al * bl;
    return error;
}

// Sine and cosine of r + tail, |r| <= pi/4.
double double_kernel_sine(double r, double tail) {
    double z = r * r;
    double v = z * r;
    double p = 8.33333333332248946124e-03lf + z * (-1.98412698298579493134e-04lf + z * (2.75573137070700676789e-06lf
        + z * (-2.50507602534068634195e-08lf + z * 1.58969099521155010221e-10lf)));
    precise double y = r - ((z * (0.5lf * tail - v * p) - tail) - v * -1.66666666666666324348e-01lf);
    return y;
}

double double_kernel_cosine(double r, double tail) {
    double z = r * r;
    double p = z * (4.16666666666666019037e-02lf + z * (-1.38888888888741095749e-03lf + z * (2.48015872894767294178e-05lf
        + z * (-2.75573143513906633035e-07lf + z * (2.08757232129817482790e-09lf + z * -1.13596475577881948265e-11lf)))));
    precise double half_square = 0.5lf * z;
    precise double w = 1.0lf - half_square;
    precise double y = w + (((1.0lf - w) - half_square) + (z * p - r * tail));
    return y;
}

// x - n pi/2 as r + tail, with pi/2 in three parts of 33 bits and a rest: exact products for |n| < 2^20, |x| < 1.6e6.
int double_reduce(double x, precise out double r, precise out double tail) {
    double n = floor(x * 0.636619772367581343076lf + 0.5lf);
    precise double a = x - n * 1.57079632673412561417lf;
    precise double second = n * 6.07710050630396597660e-11lf;
    precise double b = a - second;
    precise double b_error = (a - b) - second;
    precise double third = n * 2.02226624871116645580e-21lf;
    precise double c = b - third;
    precise double w = (n * 8.47842766036889956997e-32lf - ((b - c) - third)) - b_error;
    r = c - w;
    tail = (c - r) - w;
    return int(mod(n, 4.0lf));
}

double double_sin(double x) {
    double r, tail;
    int n = double_reduce(x, r, tail);
    double s = (n & 1) == 0 ? double_kernel_sine(r, tail) : double_kernel_cosine(r, tail);
    s = (n & 2) == 0 ? s : -s;
    return x == 0.0lf ? x : (isinf(x) || isnan(x) ? double_nan() : s);
}

double double_cos(double x) {
    double r, tail;
    int n = double_reduce(x, r, tail);
    double c = (n & 1) == 0 ? double_kernel_cosine(r, tail) : double_kernel_sine(r, tail);
    c = ((n + 1) & 2) == 0 ? c : -c;
    return isinf(x) || isnan(x) ? double_nan() : c;
}

double double_tan(double x) { return double_sin(x) / double_cos(x); }

// P/Q with asin(x) = x + x P/Q(x^2) for |x| <= 0.5.
double double_arcsine_ratio(double z) {
    double p = z * (1.66666666666666657415e-01lf + z * (-3.25565818622400915405e-01lf + z * (2.01212532134862925881e-01lf
        + z * (-4.00555345006794114027e-02lf + z * (7.91534994289814532176e-04lf + z * 3.47933107596021167570e-05lf)))));
    double q = 1.0lf + z * (-2.40339491173441421878e+00lf + z * (2.02094576023350569471e+00lf
        + z * (-6.88283971605453293030e-01lf + z * 7.70381505559019352791e-02lf)));
    return p / q;
}

double double_asin(double x) {
    double a = abs(x);
    double z = 0.5lf * (1.0lf - a);
    double s = sqrt(max(z, 0.0lf));
    double high = double_head(s);
    precise double low = s > 0.0lf ? (z - high * high) / (s + high) : 0.0lf;
    double w = 2.0lf * s * double_arcsine_ratio(z) - (DOUBLE_HALF_PI_LOW - 2.0lf * low);
    precise double large = 0.25lf * DOUBLE_PI - (w - (0.25lf * DOUBLE_PI - 2.0lf * high));
    double y = a < 0.5lf ? a + a * double_arcsine_ratio(a * a) : large;
    return a <= 1.0lf ? (x < 0.0lf ? -y : y) : double_nan();
}

double double_acos(double x) {
    double a = abs(x);
    double z = 0.5lf * (1.0lf - a);
    double s = sqrt(max(z, 0.0lf));
    double high = double_head(s);
    precise double low = s > 0.0lf ? (z - high * high) / (s + high) : 0.0lf;
    double ratio = double_arcsine_ratio(a < 0.5lf ? a * a : z);
    precise double near_zero = DOUBLE_HALF_PI - (x - (DOUBLE_HALF_PI_LOW - x * ratio));
    double near_one = 2.0lf * (high + (ratio * s + low));
    precise double near_minus_one = DOUBLE_PI - 2.0lf * (s + (ratio * s - DOUBLE_HALF_PI_LOW));
    double y = a < 0.5lf ? near_zero : (x > 0.0lf ? near_one : near_minus_one);
    return a <= 1.0lf ? y : double_nan();
}

double double_atan(double x) {
    double a = abs(x);
    // The nearest of atan 0, 0.5, 1, 1.5 and infinity, in two parts, and the tangent of what is left.
    double high = 0.0lf, low = 0.0lf, t = a;
    if (a >= 2.4375lf) {
        high = DOUBLE_HALF_PI; low = DOUBLE_HALF_PI_LOW; t = -1.0lf / a;
    } else if (a >= 1.1875lf) {
        high = 9.82793723247329054082e-01lf; low = 1.39033110312309984516e-17lf; t = (a - 1.5lf) / (1.0lf + 1.5lf * a);
    } else if (a >= 0.6875lf) {
        high = 7.85398163397448278999e-01lf; low = 3.06161699786838301793e-17lf; t = (a - 1.0lf) / (a + 1.0lf);
    } else if (a >= 0.4375lf) {
        high = 4.63647609000806093515e-01lf; low = 2.26987774529616870924e-17lf; t = (2.0lf * a - 1.0lf) / (2.0lf + a);
    }
    double z = t * t;
    double w = z * z;
    double s1 = z * (3.33333333333329318027e-01lf + w * (1.42857142725034663711e-01lf + w * (9.09088713343650656196e-02lf
        + w * (6.66107313738753120669e-02lf + w * (4.97687799461593236017e-02lf + w * 1.62858201153657823623e-02lf)))));
    double s2 = w * (-1.99999999998764832476e-01lf + w * (-1.11111104054623557880e-01lf + w * (-7.69187620504482999495e-02lf
        + w * (-5.83357013379057348645e-02lf + w * -3.65315727442169155270e-02lf))));
    precise double y = high - ((t * (s1 + s2) - low) - t);
    return isnan(x) ? x : (x < 0.0lf ? -y : y);
}

double double_atan(double y, double x) {
    if (isnan(x) || isnan(y)) return double_nan();
    if (x == 0.0lf && y == 0.0lf) return 0.0lf; // undefined in GLSL
    bool steep = abs(y) > abs(x);
    bool both_infinite = isinf(x) && isinf(y);
    double ratio = both_infinite ? 1.0lf : (steep ? abs(x) / abs(y) : abs(y) / abs(x));
    double angle = double_atan(ratio);
    angle = steep ? DOUBLE_HALF_PI - (angle - DOUBLE_HALF_PI_LOW) : angle;
    angle = x < 0.0lf ? DOUBLE_PI - (angle - 2.0lf * DOUBLE_HALF_PI_LOW) : angle;
    return y < 0.0lf ? -angle : angle;
}

// exp(x + tail) for a small tail. 2^k is applied in two steps, so that results may be denormal.
double double_exp(double x, double tail) {
    if (isnan(x)) return x;
    if (x > 709.782712893383973096lf) return double_infinity();
    if (x < -745.13321910194110842lf) return 0.0lf;
    double k = floor(x * DOUBLE_INV_LN2 + 0.5lf);
    precise double high = x - k * DOUBLE_LN2_HIGH;
    precise double low = k * DOUBLE_LN2_LOW - tail;
    precise double r = high - low;
    double t = r * r;
    double c = r - t * (1.66666666666666019037e-01lf + t * (-2.77777777770155933842e-03lf + t * (6.61375632143793436117e-05lf
        + t * (-1.65339022054652515390e-06lf + t * 4.13813679705723846039e-08lf))));
    precise double y = 1.0lf - ((low - r * c / (2.0lf - c)) - high);
    int first = int(k) / 2;
    return y * double_power_of_two(first) * double_power_of_two(int(k) - first);
}

double double_exp(double x) { return double_exp(x, 0.0lf); }

// log(x) as high + low, x > 0 and finite.
double double_log_parts(double x, precise out double low) {
    int k = 0;
    if (x < 2.2250738585072014e-308lf) { // a denormal
        x *= 18014398509481984.0lf;
        k = -54;
    }
    uvec2 words = unpackDouble2x32(x);
    k += int(words.y >> 20u) - 1023;
    double m = packDouble2x32(uvec2(words.x, (words.y & 0xfffffu) | 0x3ff00000u));
    if (m > 1.41421356237309505lf) {
        m *= 0.5lf;
        k += 1;
    }
    precise double f = m - 1.0lf;
    precise double d = 2.0lf + f;
    precise double d_low = f - (d - 2.0lf);
    precise double s = f / d;
    precise double p = s * d;
    precise double s_low = ((f - p) - double_product_error(s, d, p) - s * d_low) / d;
    double z = s * s;
    double w = z * z;
    double t1 = w * (3.999999999940941908e-01lf + w * (2.222219843214978396e-01lf + w * 1.531383769920937332e-01lf));
    double t2 = z * (6.666666666666735130e-01lf + w * (2.857142874366239149e-01lf + w * (1.818357216161805012e-01lf
        + w * 1.479819860511658591e-01lf)));
    double rest = s * (t1 + t2);
    double e = double(k);
    precise double a = e * DOUBLE_LN2_HIGH, b = 2.0lf * s;
    precise double sum = a + b;
    precise double b_part = sum - a;
    precise double error = (a - (sum - b_part)) + (b - b_part);
    precise double tail = ((2.0lf * s_low + e * DOUBLE_LN2_LOW) + error) + rest;
    precise double high = sum + tail;
    low = tail - (high - sum);
    return high;
}

double double_log(double x) {
    if (isnan(x) || x < 0.0lf) return double_nan();
    if (x == 0.0lf) return -double_infinity();
    if (isinf(x)) return x;
    double low;
    double high = double_log_parts(x, low);
    return high + low;
}

double double_exp2(double x) {
    precise double p = x * DOUBLE_LN2;
    return double_exp(p, double_product_error(x, DOUBLE_LN2, p) + x * 2.3190468138462996e-17lf);
}

double double_log2(double x) {
    if (!(x > 0.0lf) || isinf(x)) return double_log(x);
    double low;
    double high = double_log_parts(x, low);
    precise double p = high * DOUBLE_INV_LN2;
    return p + (double_product_error(high, DOUBLE_INV_LN2, p) + (low * DOUBLE_INV_LN2 + high * 2.0355273740931033e-17lf));
}

// Good to 3 ulp between e^-50 and e^50, to 32 beyond. IEEE 754: pow(x, 0) = 1; a negative base has no value here, as in GLSL.
double double_pow(double x, double y) {
    if (isnan(x) || isnan(y) || x < 0.0lf) return double_nan();
    if (y == 0.0lf || x == 1.0lf) return 1.0lf;
    if (x == 0.0lf || isinf(x)) return (x == 0.0lf) == (y > 0.0lf) ? 0.0lf : double_infinity();
    double low;
    double high = double_log_parts(x, low);
    precise double p = y * high;
    if (!(abs(p) < 800.0lf)) return p > 0.0lf ? double_infinity() : 0.0lf;
    return double_exp(p, double_product_error(y, high, p) + y * low);
}

// The series near 0 avoids the cancellation of the exponentials.
double double_sinh(double x) {
    double z = x * x;
    double series = x * (1.0lf + z / 6.0lf * (1.0lf + z / 20.0lf * (1.0lf + z / 42.0lf * (1.0lf + z / 72.0lf * (1.0lf
        + z / 110.0lf * (1.0lf + z / 156.0lf * (1.0lf + z / 210.0lf * (1.0lf + z / 272.0lf * (1.0lf + z / 342.0lf)))))))));
    double e = double_exp(0.5lf * abs(x));
    double y = 0.5lf * e * e - 0.5lf / (e * e);
    return abs(x) < 1.0lf ? series : (x < 0.0lf ? -y : y);
}

double double_cosh(double x) {
    double e = double_exp(0.5lf * abs(x));
    return 0.5lf * e * e + 0.5lf / (e * e);
}

double double_tanh(double x) {
    double a = min(abs(x), 20.0lf);
    double y = double_sinh(a) / double_cosh(a);
    return isnan(x) ? x : (x < 0.0lf ? -y : y);
}

double double_asinh(double x) {
    double a = abs(x), z = x * x;
    precise double u = a + z / (1.0lf + sqrt(1.0lf + z)), v = 1.0lf + u;
    // log(1 + u) with the rounding of 1 + u put right.
    precise double y = a > 1.0e150lf ? double_log(a) + DOUBLE_LN2 : double_log(v) - ((v - 1.0lf) - u) / v;
    return x < 0.0lf ? -y : y;
}

double double_acosh(double x) {
    double t = x - 1.0lf;
    precise double u = t + sqrt(max(t * (2.0lf + t), 0.0lf)), v = 1.0lf + u;
    precise double y = x > 1.0e150lf ? double_log(x) + DOUBLE_LN2 : double_log(v) - ((v - 1.0lf) - u) / v;
    return x >= 1.0lf ? y : double_nan();
}

double double_atanh(double x) {
    double a = abs(x);
    precise double u = 2.0lf * a / (1.0lf - a), v = 1.0lf + u;
    precise double y = 0.5lf * (double_log(v) - (isinf(v) ? 0.0lf : ((v - 1.0lf) - u) / v));
    return x < 0.0lf ? -y : y;
}

double double_radians(double x) { return x * 0.0174532925199432957692lf; }
double double_degrees(double x) { return x * 57.2957795130823208768lf; }

// Code that looks at the bits of a float means those of the float, also where it is widened.
uint double_floatBitsToUint(double x) { return floatBitsToUint(float(x)); }
int double_floatBitsToInt(double x) { return floatBitsToInt(float(x)); }
double double_uintBitsToFloat(uint x) { return double(uintBitsToFloat(x)); }
double double_intBitsToFloat(int x) { return double(intBitsToFloat(x)); }

#define DOUBLE_VECTORS(f) \
    dvec2 f(dvec2 v) { return dvec2(f(v.x), f(v.y)); } \
    dvec3 f(dvec3 v) { return dvec3(f(v.x), f(v.y), f(v.z)); } \
    dvec4 f(dvec4 v) { return dvec4(f(v.x), f(v.y), f(v.z), f(v.w)); }
#define DOUBLE_VECTOR_PAIRS(f) \
    dvec2 f(dvec2 a, dvec2 b) { return dvec2(f(a.x, b.x), f(a.y, b.y)); } \
    dvec3 f(dvec3 a, dvec3 b) { return dvec3(f(a.x, b.x), f(a.y, b.y), f(a.z, b.z)); } \
    dvec4 f(dvec4 a, dvec4 b) { return dvec4(f(a.x, b.x), f(a.y, b.y), f(a.z, b.z), f(a.w, b.w)); }

DOUBLE_VECTORS(double_sin)
DOUBLE_VECTORS(double_cos)
DOUBLE_VECTORS(double_tan)
DOUBLE_VECTORS(double_asin)
DOUBLE_VECTORS(double_acos)
DOUBLE_VECTORS(double_atan)
DOUBLE_VECTOR_PAIRS(double_atan)
DOUBLE_VECTORS(double_sinh)
DOUBLE_VECTORS(double_cosh)
DOUBLE_VECTORS(double_tanh)
DOUBLE_VECTORS(double_asinh)
DOUBLE_VECTORS(double_acosh)
DOUBLE_VECTORS(double_atanh)
DOUBLE_VECTORS(double_exp)
DOUBLE_VECTORS(double_log)
DOUBLE_VECTORS(double_exp2)
DOUBLE_VECTORS(double_log2)
DOUBLE_VECTOR_PAIRS(double_pow)
DOUBLE_VECTORS(double_radians)
DOUBLE_VECTORS(double_degrees)

#endif
