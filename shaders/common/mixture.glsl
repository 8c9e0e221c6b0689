// One random number for the choice between two branches and for the branch itself.
#ifndef SAMPLERSCOPE_MIXTURE
#define SAMPLERSCOPE_MIXTURE

// The part [p, 1) of the unit interval, in which u lies, stretched to [0, 1). Rounding must not make it 1.
float stretched(float u, float p) {
    return min((u - p) / (1.0 - p), ONE_MINUS_EPSILON);
}

#endif
