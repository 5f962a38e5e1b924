// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/gate/unexpected_frames.hpp"

#include "tests/hal/support/frames.hpp"
#include "tests/support/catch.hpp"

namespace unexpected_frames_test {

using namespace dfdyn::hal;

TEST_CASE("the first unexpected frame is stored, and all are counted") {
    UnexpectedFrames offenders;
    CHECK(offenders.count() == 0);
    Frame frame = dfdyn::tests::frame_of(0x123, {1, 2, 3}, 77);
    frame.extended = true;
    offenders.add(frame, Reason::wrong_length);
    for (int i = 0; i < 9; ++i) {
        offenders.add(dfdyn::tests::frame_of(0x7FF, {}, 99), Reason::wrong_frame_type);
    }
    CHECK(offenders.count() == 10);
    CHECK(offenders.first().id == 0x123);
    CHECK(offenders.first().extended);
    CHECK(offenders.first().length == 3);
    CHECK(offenders.first().stamp_ns == 77);
    CHECK(offenders.first().reason == Reason::wrong_length);
}

} // namespace unexpected_frames_test
