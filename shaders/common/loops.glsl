// Guards against loops that end without a word. A condition of a loop in a model or technique asks `loop_goes_on`;
// `loops_ran` is asked once, after all loops: a driver that stopped loops at its own limit stops this one as well.
#ifndef SAMPLERSCOPE_LOOPS
#define SAMPLERSCOPE_LOOPS

const uint LOOP_LIMIT = 65535u; // iterations of one invocation, all loops together

uint loop_iterations = 0u;

bool loop_goes_on() {
    loop_iterations += loop_iterations < LOOP_LIMIT ? 1u : 0u;
    return loop_iterations < LOOP_LIMIT;
}

// `two` is 2, in a way that the compiler cannot know.
bool loops_ran(uint two) {
    uint ran = 0u;
    for (uint i = 0u; i < two; i++) ran++;
    return ran == two && loop_iterations < LOOP_LIMIT;
}

#endif
