// What every model and technique may rely on: the result of drawing a direction, and two constants.
#ifndef SAMPLERSCOPE_CONTRACT
#define SAMPLERSCOPE_CONTRACT

const float PI = 3.14159265358979324;
const float INV_PI = 0.318309886183790672;

// A direction drawn by a technique. wi points away from the surface; pdf is its density per steradian.
struct DirectionSample {
    vec3 wi;
    float pdf;
};

#endif
