/* What the tests of peel.h share: calls that must succeed, and calls that must fail in one line. */
#ifndef PEEL_TESTS_LIBRARY_CALLS_H
#define PEEL_TESTS_LIBRARY_CALLS_H

#include "peel.h"
#include "testing.h"

/* The call fails with that result and a message of one line that holds the text. */
#define FAILS(result, text, call)                                                                  \
    do {                                                                                           \
        PeelResult got_ = (call);                                                                  \
        ck_assert_msg(got_ == (result), "%s: got \"%s\" (%s)", #call, peel_result_text(got_),      \
                      peel_message());                                                             \
        ck_assert_msg(strstr(peel_message(), text) != NULL, "%s: \"%s\"", #call, peel_message());  \
        ck_assert_ptr_null(strchr(peel_message(), '\n'));                                          \
    } while (0)
#define BAD(text, call) FAILS(PEEL_BAD_INPUT, text, call)
#define GOOD(call)                                                                                 \
    do {                                                                                           \
        PeelResult got_ = (call);                                                                  \
        ck_assert_msg(got_ == PEEL_OK, "%s: %s", #call, peel_message());                           \
    } while (0)

/* What no enumeration has. */
#define NONE 77

#endif
