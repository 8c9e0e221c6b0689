// Statistics of the throughput weight of EON in C++: OpenMP over angles and blocks, SIMD inside a block. The vector arc
// sine comes from glibc's libmvec. Reads "technique roughness samples seed angle..." lines; writes the
// seconds taken and, for each angle, mean, variance, their fourth central moment and the largest weight.
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

constexpr int BLOCK = 1024;
constexpr float PI = 3.14159265f, INV_PI = 0.318309886f;
enum Technique { COSINE, UNIFORM, LTC, LTC_NONNEGATIVE, CLTC, CLTC_MIS };

struct View {
    float mu, sine, a, b, c, d, area, det, probability, amplitude, multiple;
};

static inline float deficit(float m) {
    float s = std::sqrt((1.f - m) * (1.f + m)), inverse = 1.f / (1.f + s);
    return 0.90412966f * m * m * inverse + s * (asinf(m) + s * m - 0.66666667f * m * (1.f + s + s * s) * inverse);
}

static View view_of(double theta, float r, Technique technique) {
    View v;
    double mu = std::cos(theta), e = 1 - mu;
    v.mu = mu;
    v.sine = std::sin(theta);
    v.a = 1 + r * (0.303392 + (-0.518982 + 0.111709 * mu) * mu + (-0.276266 + 0.335918 * mu) * r);
    v.b = r * (-1.16407 + 1.15859 * mu + (0.150815 - 0.150105 * mu) * r) / (mu * mu * mu - 1.43545);
    v.c = 1 + (0.20013 + (-0.506373 + 0.261777 * mu) * mu) * r;
    v.d = technique == LTC_NONNEGATIVE ? 0.0 : r * (-6e-6 + (0.065466 + 0.475392 * e) * e) / (-0.0017372 + (-2.0725628 + e) * e);
    bool clipped = technique == CLTC || technique == CLTC_MIS;
    v.area = clipped ? 0.5f + 0.5f / std::sqrt(1.f + v.d * v.d) : 1.f;
    v.det = v.c * (v.a - v.b * v.d);
    v.probability = technique == CLTC_MIS ? std::pow(r, 0.1f) * (0.162925 + mu * (-0.372058 + (0.538233 - 0.290822 * mu) * mu)) : 0.0;
    v.amplitude = 1.f / (1.f + 0.28779341f * r);
    v.multiple = v.amplitude * r * 0.14979450f * deficit(v.mu);
    return v;
}

// u1 of 40 bits and u2 of 24 from two words, as samplerscope forms them.
static inline void unit_square(uint32_t a, uint32_t b, float& u1, float& u2) {
    float u = float(int32_t(a >> 8)) * 5.9604645e-8f + float(int32_t((a & 255) << 8 | (b & 255))) * 9.094947e-13f;
    u1 = u < 0.99999994f ? u : 0.99999994f;
    u2 = float(int32_t(b >> 8)) * 5.9604645e-8f;
}

// cos and sin of 2 pi u by one pair of polynomials (Cephes): GCC joins sinf and cosf of one argument into a call that it
// does not vectorize, which costs a factor of six.
static inline void point_on_circle(float u, float& cosine, float& sine) {
    float quarter = std::floor(4.f * u + 0.5f);
    float a = (u - 0.25f * quarter) * 6.2831853f, t = a * a;
    float s = a + a * t * ((-1.9515296e-4f * t + 8.3321609e-3f) * t - 1.6666655e-1f);
    float c = 1.f - 0.5f * t + t * t * ((2.4433157e-5f * t - 1.3887316e-3f) * t + 4.1666646e-2f);
    int q = int(quarter);
    float x = q & 1 ? s : c, y = q & 1 ? c : s;
    cosine = (q + 1) & 2 ? -x : x;
    sine = q & 2 ? -y : y;
}

// f cos / pdf; r is the roughness.
template <Technique T>
static inline float weight(const View& v, float r, float u1, float u2) {
    float x, y, z, over_pdf;
    float cosine, sine;
    point_on_circle(u2, cosine, sine);
    if (T == COSINE || T == UNIFORM) {
        z = T == COSINE ? std::sqrt(u1) : u1;
        float radius = T == COSINE ? std::sqrt(1.f - u1) : std::sqrt((1.f - u1) * (1.f + u1));
        x = radius * cosine;
        over_pdf = T == COSINE ? PI : 2.f * PI * z;
    } else {
        bool pick = T == CLTC_MIS && u1 < v.probability;
        float first = T == CLTC_MIS ? (pick ? u1 / v.probability : (u1 - v.probability) / (1.f - v.probability)) : u1;
        float rest = 1.f - first;  // below 0 by a rounding, where fast division is inexact
        float hz = std::sqrt(first), radius = std::sqrt(rest > 0.f ? rest : 0.f);
        float hx = radius * cosine, hy = radius * sine;
        if (T == CLTC || T == CLTC_MIS) {
            // width - hx without cancellation: (width - hx)(width + hx) is u1 exactly.
            float width = std::sqrt(hx * hx + first);
            float gap = hx > 0.f ? first / (width + hx) : width - hx;
            float squeezed = width * (1.f - v.area) + v.area * hx;
            hx = v.d > 0.f ? squeezed : -squeezed;
            float sum = width + squeezed;
            hz = std::sqrt(v.area * gap * (sum > 0.f ? sum : 0.f));
        }
        x = v.a * hx + v.b * hz;
        y = v.c * hy;
        z = v.d * hx + hz;
        float squared = x * x + y * y + z * z, inverse = 1.f / std::sqrt(squared);
        x *= inverse, y *= inverse, z *= inverse;
        if (T == CLTC_MIS) {
            float up = std::sqrt((1.f - first) * (1.f + first));
            x = pick ? up * cosine : x, y = pick ? up * sine : y, z = pick ? first : z;
            float px = v.c * (x - v.b * z), py = (v.a - v.b * v.d) * y, pz = v.c * (v.a * z - v.d * x);
            float ratio = v.det / (px * px + py * py + pz * pz);
            float lobe = INV_PI * ratio * ratio * (pz > 0.f ? pz : 0.f) / v.area;
            over_pdf = z / (v.probability * 0.15915494f + (1.f - v.probability) * lobe);
        } else {
            float pdf = INV_PI * hz / v.area * squared / (inverse * v.det);
            float above = z > 0.f ? z : 0.f;
            over_pdf = pdf > 1e-30f ? above / pdf : 0.f;
            z = z > 0.f ? z : 0.f;
        }
    }
    z = z < 1.f ? z : 1.f;  // above 1 by a rounding, where fast square roots are inexact
    float s = x * v.sine, top = z > v.mu ? z : v.mu;
    float single = INV_PI * v.amplitude * (1.f + r * (s > 0.f ? s / top : s));
    return (single + v.multiple * deficit(z)) * over_pdf;
}

struct Sums {
    double s1 = 0, s2 = 0, s3 = 0, s4 = 0;
    float largest = 0;
};

template <Technique T>
static void block(const View& v, float r, uint32_t index, uint32_t angle, uint32_t seed, int count, Sums& sums) {
    float s1 = 0, s2 = 0, s3 = 0, s4 = 0, largest = 0;
#pragma omp simd reduction(+ : s1, s2, s3, s4) reduction(max : largest)
    for (int i = 0; i < count / 2; i++) {  // two samples from one hash; the count is even
        uint32_t a = uint32_t(i) * 1664525u + 1013904223u, b = index * 1664525u + 1013904223u;
        uint32_t c = angle * 1664525u + 1013904223u, d = seed * 1664525u + 1013904223u;
        a += b * d, b += c * a, c += a * b, d += b * c;
        a ^= a >> 16, b ^= b >> 16, c ^= c >> 16, d ^= d >> 16;
        a += b * d, b += c * a, c += a * b, d += b * c;
        float u1, u2, v1, v2;
        unit_square(a, b, u1, u2);
        unit_square(c, d, v1, v2);
        float w = weight<T>(v, r, u1, u2), x = weight<T>(v, r, v1, v2);
        float e = w - 1.f, f = x - 1.f;
        s1 += e + f, s2 += e * e + f * f, s3 += e * e * e + f * f * f, s4 += (e * e) * (e * e) + (f * f) * (f * f);
        float larger = w > x ? w : x;
        largest = larger > largest ? larger : largest;
    }
    sums.s1 += s1, sums.s2 += s2, sums.s3 += s3, sums.s4 += s4;
    sums.largest = largest > sums.largest ? largest : sums.largest;
}

template <Technique T>
static void run(float r, long samples, uint32_t seed, const std::vector<double>& angles, std::vector<Sums>& out) {
#pragma omp parallel for schedule(dynamic)
    for (size_t at = 0; at < angles.size(); at++) {
        View v = view_of(angles[at], r, T);
        Sums sums;
        for (long first = 0; first < samples; first += BLOCK)
            block<T>(v, r, first / BLOCK, at, seed, std::min(long(BLOCK), samples - first), sums);
        out[at] = sums;
    }
}

int main() {
    std::string line, name;
    while (std::getline(std::cin, line)) {
        std::istringstream in(line);
        float r;
        long samples;
        uint32_t seed;
        in >> name >> r >> samples >> seed;
        std::vector<double> angles;
        for (double angle; in >> angle;) angles.push_back(angle);
        std::vector<Sums> out(angles.size());
        auto begin = std::chrono::steady_clock::now();
        if (name == "cosine") run<COSINE>(r, samples, seed, angles, out);
        if (name == "uniform") run<UNIFORM>(r, samples, seed, angles, out);
        if (name == "ltc") run<LTC>(r, samples, seed, angles, out);
        if (name == "ltc-nonnegative") run<LTC_NONNEGATIVE>(r, samples, seed, angles, out);
        if (name == "cltc") run<CLTC>(r, samples, seed, angles, out);
        if (name == "cltc-mis") run<CLTC_MIS>(r, samples, seed, angles, out);
        std::chrono::duration<double> spent = std::chrono::steady_clock::now() - begin;
        std::printf("{\"seconds\": %.9g, \"powers\": [", spent.count());
        for (size_t at = 0; at < out.size(); at++)
            std::printf("%s[%.17g, %.17g, %.17g, %.17g, %.9g]", at ? ", " : "", out[at].s1, out[at].s2, out[at].s3, out[at].s4, out[at].largest);
        std::printf("]}\n");
        std::fflush(stdout);
    }
}
