// Loops for the widest registers a machine has.
#pragma once

/// Before a function: it is compiled for several generations of x86-64, and the best one the machine has is
/// chosen when the program starts. All of them do the same additions in the same order, so they give the same
/// bytes. Sanitizers cannot run code that early, and clang 14 knows no such clones: there it is empty, and so
/// it is where KEYLUME_ONE_GENERATION says that the whole file is compiled for one.
#if !defined(KEYLUME_ONE_GENERATION) && defined(__x86_64__) && defined(__GNUC__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && !defined(__clang__)
#define KEYLUME_WIDEST __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define KEYLUME_WIDEST
#endif
