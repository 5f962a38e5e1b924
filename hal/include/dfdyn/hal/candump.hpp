// SPDX-License-Identifier: Apache-2.0
#pragma once

// Reads and writes single lines of the logs of `candump -L` and `candump -l`:
//
//     (1700000000.123456) can0 123#DEADBEEF            classic CAN; ID has 3 digits, or 8 for 29 bits
//     (1700000000.123456789) can0 00000123#DE.AD T     nanoseconds, dots, sent by the logging host itself
//     (1700000000.123456) can0 123#R4                  remote request
//     (1700000000.123456) can0 123##1DEADBEEF          CAN FD, with its flags
//     (1700000000.123456) can0 123#0011223344556677_B  raw length code above 8
//     (1700000000.123456) can0 20000040#0000000000000000      error frame
//     DROPCOUNT: dropped 3 CAN frames on 'can0' socket (total drops 7)

#include "dfdyn/hal/candump_parse.hpp"
#include "dfdyn/hal/candump_write.hpp"
