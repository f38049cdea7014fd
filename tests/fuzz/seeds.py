#!/usr/bin/env python3
"""Writes the seeds of the corpora that are made by rule: one for each branch that mutation alone finds late, because
a checksum or a length guards it. Usage: tests/fuzz/seeds.py (from anywhere); the files seed_* are replaced."""

import bz2
import gzip
import json
import pathlib
import sqlite3
import struct
import tempfile
import zlib

CORPUS = pathlib.Path(__file__).resolve().parent / "corpus"
PIECE = b"\x3f"  # reads of 64 bytes


def seed(harness, name, data):
    folder = CORPUS / harness
    folder.mkdir(exist_ok=True)
    (folder / ("seed_" + name)).write_bytes(data if isinstance(data, bytes) else data.encode())


def xor(data):
    out = 0
    for byte in data:
        out ^= byte
    return out


# CAN ------------------------------------------------------------------------------------------------------------------


def candump():
    seed("candump", "kinds", "(1.0) can0 123#AA\n(1.1) can0 12345678#AABB R\n(1.2) can0 123#R5\n(1.3) can0 123#R\n"
         "(1.25) can0 20000004#0004000000000000\n(1.5) can0 123##1AABB\n(1.6) can0 080#\nrubbish\n\n"
         "(1.7) can0 123#AA.BB\n(1.8) can0 123#1122334455667788_9\n(1.9) can0 123#112233445566")
    seed("candump", "cut", "(1.0) can0 123#AA\n(1.1) can0 12")
    seed("candump", "screen", "  can0  123   [2]  AA BB\n  can0  124   [1]  AA\n")
    for name, begin in (("blf", "LOGG"), ("asc", "date Mon\n"), ("trace", ";$FILEVERSION=1.1\n"), ("lcm", b"\xed\xa1\xda\x01")):
        seed("candump", name, begin)


def slcan():
    seed("slcan", "answers", PIECE + b"\r\a z\rZ\rV1013\rN4242\rF00\rsb255000\rsp\rz\r")
    seed("slcan", "frames", PIECE + b"t1232AABB\rT123456782AABB\rr1232\rR123456788\rt1231AAEA5F\rt12G0\rT2FFFFFFF0\rt1239\r")
    seed("slcan", "long", PIECE + b"t" * 400 + b"\rt1230\r" + b"x" * 300 + b"\a" + b"t1230\r")


def sdo():
    def frame(*data, wait=1, length=8):
        return bytes([wait, length]) + bytes(data) + bytes(8 - len(data))

    name = (0x00, 0x21, 0x01)
    segments = frame(0x41, *name, 9, 0, 0, 0) + frame(0x00, 1, 2, 3, 4, 5, 6, 7) + frame(0x1B, 1, 2)
    read, write_short, write_long = b"\x00", b"\x03", b"\x3f"
    seed("sdo", "read", read + frame(0x43, *name, 1, 2, 3, 4))
    seed("sdo", "read_segments", read + segments)
    seed("sdo", "read_unsized", read + frame(0x40, *name) + frame(0x00, 1, 2, 3, 4, 5, 6, 7) + frame(0x11, 1, 2, 3))
    seed("sdo", "read_too_many", read + frame(0x41, *name, 3, 0, 0, 0) + frame(0x00, 1, 2, 3, 4, 5, 6, 7))
    seed("sdo", "read_too_few", read + frame(0x41, *name, 9, 0, 0, 0) + frame(0x01, 1, 2, 3, 4, 5, 6, 7))
    seed("sdo", "read_huge", read + frame(0x41, *name, 0, 0, 1, 0))
    seed("sdo", "read_toggle", read + frame(0x41, *name, 9, 0, 0, 0) + frame(0x10, 1, 2, 3))
    seed("sdo", "read_segment_command", read + frame(0x41, *name, 9, 0, 0, 0) + frame(0x60, 1, 2, 3))
    seed("sdo", "read_command", read + frame(0x60, *name))
    seed("sdo", "abort", read + frame(0x80, *name, 0, 0, 2, 6))
    seed("sdo", "other_object", read + frame(0x43, 1, 0x21, 1, 0) + frame(0x43, *name, 1))
    seed("sdo", "short", read + frame(0x43, 0, length=2))
    seed("sdo", "timeouts", b"\x02" + b"".join(frame(0x43, 9, 9, 9, wait=255) for _ in range(8)))
    seed("sdo", "write", write_short + frame(0x60, *name))
    seed("sdo", "write_command", write_short + frame(0x43, *name))
    seed("sdo", "write_segments", write_long + frame(0x60, *name) +
         b"".join(frame(0x20 | 0x10 * (i % 2)) for i in range(5)))
    seed("sdo", "write_toggle", write_long + frame(0x60, *name) + frame(0x30))
    seed("sdo", "write_segment_command", write_long + frame(0x60, *name) + frame(0x00))


def speed_can():
    def record(frame_id, data, extended=False, wish=0, length=None, remote=False):
        kind = (1 if extended else 0) | (2 if remote else 0)
        data = bytes(data)
        size = len(data) if length is None else length
        return bytes([kind, size]) + struct.pack(">I", frame_id) + data.ljust(8, b"\0")[:8] + bytes([wish, 0])

    everything = 63
    agilex = b"".join(record(i, bytes(range(8)), wish=everything) for i in (0x211, 0x221, 0x251, 0x252, 0x311, 0x41A))
    agilex += record(0x211, [0, 2, 1, 0, 0, 4, 0, 0], wish=everything) + record(0x311, bytes(8)) + record(0x311, [1, 2], length=2)
    seed("speed_can", "agilex", agilex)
    odrive = b"".join(record(n << 5 | c, bytes(range(1, 9)), wish=everything) for n in (0, 1, 2) for c in (1, 9, 10, 3, 23))
    odrive += record(1 << 5 | 1, [0, 0, 0, 0, 8, 0, 0, 0]) + record(1 << 5 | 9, struct.pack("<ff", float("nan"), 1e30))
    odrive += record(1 << 5 | 10, struct.pack("<ii", 5, 6)) + record(1 << 5 | 10, [1, 2, 3])
    seed("speed_can", "odrive", odrive)
    segway = b"".join(record(0x400 + i, bytes(range(8)), wish=everything) for i in range(8))
    seed("speed_can", "segway", segway)
    vesc = b"".join(record(c << 8 | n, bytes(range(8)), extended=True, wish=everything)
                    for n in (1, 2) for c in (9, 14, 15, 16, 27, 28))
    packet = bytes([93]) + bytes(range(1, 60))

    def crc16(data):
        crc = 0
        for byte in data:
            crc ^= byte << 8
            for _ in range(8):
                crc = (crc << 1 ^ (0x1021 if crc & 0x8000 else 0)) & 0xFFFF
        return crc

    for body in (packet, bytes([91]) + bytes(range(200)) + bytes(150), bytes([4, 1])):
        at = 0
        while at < len(body):
            if at <= 255:
                piece = body[at:at + 7]
                vesc += record(5 << 8 | 0x7F, bytes([at]) + piece, extended=True)
            else:
                piece = body[at:at + 6]
                vesc += record(6 << 8 | 0x7F, struct.pack(">H", at) + piece, extended=True)
            at += len(piece)
        vesc += record(7 << 8 | 0x7F, bytes([1, 0]) + struct.pack(">HH", len(body), crc16(body)), extended=True)
    vesc += record(8 << 8 | 0x7F, bytes([1, 0, 4, 1, 2, 3]), extended=True)
    vesc += record(6 << 8 | 0x7F, [0xFF, 0xFF, 1], extended=True) + record(5 << 8 | 0x7F, [], extended=True)
    vesc += record(7 << 8 | 0x7F, [1, 0, 0xFF, 0xFF, 0, 0], extended=True) + record(7 << 8 | 0x7F, [1], extended=True)
    vesc += record(9 << 8 | 1, [1], extended=True) + record(27 << 8 | 1, [1, 2], extended=True)
    seed("speed_can", "vesc", vesc)


# serial bases ---------------------------------------------------------------------------------------------------------


def arcos(*data):
    body = bytes(data)
    total = 0
    for i in range(0, len(body) - 1, 2):
        total += body[i] << 8 | body[i + 1]
    if len(body) % 2:
        total ^= body[-1]
    return b"\xfa\xfb" + bytes([len(body) + 2]) + body + struct.pack(">H", total & 0xFFFF)


def speed_serial():
    out = b"\x3f" + arcos(0) + arcos(1) + arcos(2, *b"Pioneer\0P3DX\0serial\0")
    out += arcos(0x90, *range(9)) + arcos(0x90, 1, 2) + arcos(0x33, *range(20)) + arcos(0x32, *range(20, 60))
    out += arcos(0x32, 1, 2) + arcos(0x20, *b"Pioneer\0P3\0x\x01\0", *range(120)) + arcos(0x20, 1) + arcos(0x77, 1)
    out += arcos(2, *b"no end") + b"\xfa\xfb\xfa\xfb\x02\xfa\xfb\xff" + bytes(40)
    seed("speed_serial", "arcos", out)
    lines = b"10 20\rOK\r-5 7\r0 0\rError\r1\r1 2 3\r99999999999999999999 1\r" + b"x" * 200 + b"\r" + bytes(3)
    seed("speed_serial", "arduino", b"\x00" + lines + lines)
    seed("speed_serial", "arduino_silent", b"\x01" + b"\n" * 600)


# lidars ---------------------------------------------------------------------------------------------------------------


def ld06_packet(start, end, stamp, speed=3600, mm=1000):
    body = struct.pack("<BBHH", 0x54, 0x2C, speed, start)
    body += b"".join(struct.pack("<HB", mm + i, 200) for i in range(12)) + struct.pack("<HH", end, stamp)
    crc = 0
    for byte in body:
        crc ^= byte
        for _ in range(8):
            crc = (crc << 1 ^ (0x4D if crc & 0x80 else 0)) & 0xFF
    return body + bytes([crc])


def ld06():
    turn = b"".join(ld06_packet(k * 960 % 36000, (k * 960 + 880) % 36000, int((k + 1) * 8 / 3) % 30000) for k in range(80))
    seed("ld06", "turns", PIECE + turn)
    odd = ld06_packet(0, 880, 1, speed=0) + ld06_packet(40000, 880, 1) + ld06_packet(0, 880, 31000) + ld06_packet(0, 5000, 1)
    lost = ld06_packet(0, 880, 10) + ld06_packet(960, 1840, 13) + ld06_packet(2 * 9600, 2 * 9600 + 880, 66)
    seed("ld06", "odd", PIECE + odd + lost + lost[:-1] + b"\0" + ld06_packet(0, 880, 5))


def rplidar():
    def descriptor(kind, length, multiple=True):
        return b"\xa5\x5a" + struct.pack("<I", length | (0x40000000 if multiple else 0)) + bytes([kind])

    def capsule(body):
        total = xor(body)
        return bytes([0xA0 | total & 15, 0x50 | total >> 4]) + body

    def capsules(kind, size, count):
        out = b""
        for k in range(count):
            angle = int(64 * (k * 23.0 % 360)) | (0x8000 if k == 0 else 0)
            head = bytes(6) if kind == 0x86 else b""
            body = head + struct.pack("<H", angle)
            filler = bytes((k * 37 + i * 11) % 256 for i in range(size - 2 - len(body)))
            out += capsule(body + filler)
        return out

    kinds = {"express": (0x82, 84), "ultra": (0x84, 132), "dense": (0x85, 84), "ultra_dense": (0x86, 170)}
    for name, (kind, size) in kinds.items():
        seed("rplidar", name, PIECE + descriptor(kind, size) + capsules(kind, size, 20))
        seed("rplidar", name + "_unannounced", PIECE + b"\x01\x02" + capsules(kind, size, 6))
    # A recording that begins late (an odd first byte: the device's own times): the layout shows, or it does not.
    def late(body_of, count):
        return b"\xff" + b"".join(capsule(struct.pack("<H", int(64 * (k * 23.0 % 360))) + body_of(k)) for k in range(count))

    seed("rplidar", "late_express", late(lambda k: struct.pack("<HHB", (1500 + 8 * k) << 2, (1504 + 8 * k) << 2, 0) * 16, 8))
    seed("rplidar", "late_dense", late(lambda k: struct.pack("<40H", *(1800 + 10 * (40 * k + i) for i in range(40))), 8))
    seed("rplidar", "late_empty", late(lambda k: bytes(80), 34))
    seed("rplidar", "late_empty_and_cut", late(lambda k: bytes(80), 3) + bytes(90))
    seed("rplidar", "late_short", late(lambda k: bytes(80), 2) + b"\xa5")
    hq = b"\xa5" + bytes(8) + b"".join(struct.pack("<HIBB", i * 170, 4000 + i, 40, 1 if i == 0 else 0) for i in range(96))
    hq += struct.pack("<I", zlib.crc32(hq + bytes(-len(hq) % 4)))
    seed("rplidar", "hq", PIECE + descriptor(0x83, 781) + hq + hq)
    seed("rplidar", "hq_unannounced", PIECE + hq + hq)

    def point(k):
        start = k % 36 == 0
        return bytes([40 << 2 | (1 if start else 2)]) + struct.pack("<HH", int(640 * (k % 36)) << 1 | 1, 4000 + k)

    points = b"".join(point(k) for k in range(120))
    seed("rplidar", "standard", PIECE + descriptor(0x81, 5) + points + b"\0\0" + points[:300] + b"\x01\x00" + points)
    seed("rplidar", "standard_unannounced", PIECE + b"\x07" + points)
    info = descriptor(4, 20, False) + bytes(range(20)) + descriptor(6, 3, False) + b"\0\1\2"
    info += descriptor(0x15, 4, False) + struct.pack("<HH", 500, 250)
    for key, value in ((0x70, b"\1\0"), (0x71, struct.pack("<I", 64000)), (0x74, struct.pack("<I", 4096 * 25)),
                       (0x75, b"\x82"), (0x7C, b"\1\0"), (0x7F, b"Boost\0"), (0x99, b"what")):
        body = struct.pack("<I", key) + value
        info += descriptor(0x20, len(body), False) + body
    info += descriptor(0xFF, 2, False) + b"ab" + descriptor(4, 3, False) + b"abc" + descriptor(6, 1, False) + b"x"
    info += descriptor(0x15, 1, False) + b"x" + descriptor(0x20, 1, False) + b"x" + descriptor(5, 0, False)
    info += descriptor(0x99, 10) + descriptor(4, 5000, False) + descriptor(0x82, 84)
    seed("rplidar", "answers", PIECE + info + capsules(0x82, 84, 3))
    stopped = capsule(struct.pack("<H", 640) + bytes(80))
    jump = capsule(struct.pack("<H", 64 * 200) + bytes(80))
    seed("rplidar", "spans", PIECE + descriptor(0x82, 84) + stopped + stopped + capsules(0x82, 84, 6) + jump + stopped)


def cola_binary(body):
    return b"\2\2\2\2" + struct.pack(">I", len(body)) + body + bytes([xor(body)])


def cola_scan(counter, status=0, layer=0, strengths=True, encoders=0, beams=9, name=b"DIST1"):
    body = struct.pack(">HHIBBHHII", 1, 1, 4711, 0, status, counter, counter, 40000 * counter, 40000 * counter + 21000)
    body += bytes(4) + struct.pack(">hII", layer, 2500, 5400) + struct.pack(">H", encoders) + bytes(6 * encoders)

    def channel(label, values):
        return label + struct.pack(">ffiHH", 1.0, 0.0, -450000, 5000, len(values)) + b"".join(
            struct.pack(">H", v) for v in values)

    all_channels = [channel(name, [1000 + i for i in range(beams)])]
    if strengths:
        all_channels.append(channel(b"RSSI1", [100 + i for i in range(beams)]))
    body += struct.pack(">H", len(all_channels)) + b"".join(all_channels)
    return body + struct.pack(">H", 0) + bytes(10)


def cola():
    scans = [cola_scan(1), cola_scan(2, encoders=1), cola_scan(2), cola_scan(3, layer=250), cola_scan(7, status=1),
             cola_scan(8, status=2, strengths=False), cola_scan(9, name=b"DIST2"), cola_scan(10, encoders=9),
             cola_scan(11, beams=1), cola_scan(12, status=2)]
    out = b"".join(cola_binary(b"sSN LMDscandata " + scan) for scan in scans)
    seed("cola", "scans", PIECE + out)
    seed("cola", "one_bad", PIECE + cola_binary(b"sSN LMDscandata " + cola_scan(1))[:-1] + b"\0" +
         cola_binary(b"sAN mLMPsetscancfg \0") + b"\2\2\2\2\xff\xff\xff\xff" + cola_binary(b"x") + cola_binary(b"sRA"))
    text = ("\x02sSN LMDscandata 1 1 1267 0 0 1 1 9C40 EA60 0 0 0 0 0 9C4 1518 0 2 DIST1 3F800000 00000000 FFF92230 1388 "
            "3 3E8 3E9 3EA RSSI1 3F800000 00000000 FFF92230 1388 3 64 65 66 0 0 0 0 0 0\x03")
    seed("cola", "text", PIECE + text.encode() + text.replace("1267 0 0 1 1", "1267 0 2 2 2").encode() +
         b"\x02sFA 9\x03\x02sRA DeviceIdent 7 SIM 111 3 1.0\x03\x02no end")
    ident = cola_binary(b"sRA DeviceIdent \x00\x03SIM\x00\x031.0")
    state = cola_binary(b"sRA SCdevicestate \x01")
    # The driver asks at the end of its first read: answers before that are nobody's.
    seed("cola", "dialogue", PIECE + bytes(64) + ident + bytes(64) + state + bytes(64) + out[:400])
    seed("cola", "dialogue_refused", PIECE + bytes(64) + ident + bytes(64) + cola_binary(b"sFA \x00\x04") * 2)
    seed("cola", "dirty", PIECE + cola_binary(b"sSN LMDscandata " + cola_scan(1, status=2)))
    seed("cola", "broken", PIECE + cola_binary(b"sSN LMDscandata " + cola_scan(1, status=1)))


def scip_sum(line):
    return bytes([sum(line) % 64 + 0x30])


def scip_reply(echo, status, lines, parameter=False):
    out = echo + b"\n" + status + scip_sum(status) + b"\n"
    for line in lines:
        out += line + scip_sum(line[:-1] if parameter else line) + b"\n"
    return out + b"\n"


def scip_scan(stamp, values=6, strengths=False):
    def chars(value, count):
        return bytes(value >> 6 * i & 63 for i in reversed(range(count))).translate(bytes((i + 48) % 256 for i in range(256)))

    data = b"".join(chars(1000 + i, 3) + (chars(500, 3) if strengths else b"") for i in range(values))
    echo = b"%s0000%04d0100" % (b"ME" if strengths else b"MD", values - 1) + b"0"
    return scip_reply(echo[:15], b"99", [chars(stamp, 4)] + [data[i:i + 64] for i in range(0, len(data), 64)])


def scip():
    def parameters(**change):
        values = {"DMIN": 23, "DMAX": 60000, "ARES": 1440, "AMIN": 0, "AMAX": 1080, "AFRT": 540, "SCAN": 2400, **change}
        return scip_reply(b"PP", b"00", [b"MODL:SIM;"] + [b"%s:%d;" % (k.encode(), v) for k, v in values.items()], True)

    seed("scip", "scans", PIECE + parameters() + b"".join(scip_scan(s) for s in (100, 125, 125, 150, 300, 325)) +
         scip_scan(350, strengths=True) + scip_scan(16777200) + scip_scan(10))
    seed("scip", "no_parameters", PIECE + scip_scan(100) + scip_scan(125, strengths=True) + parameters(ARES=0))
    seed("scip", "replies", PIECE + scip_reply(b"II", b"00", [b"MODL:SIM;", b"LASR:ON;"], True) +
         scip_reply(b"TM1", b"00", [b"0001"]) + scip_reply(b"BM", b"02", []) + scip_reply(b"XX", b"0E", [b"plain text"]) +
         scip_reply(b"MD0000108001000", b"10", []) + b"MD0000\n99b\n00\n\n" + b"noise\n\n" + b"x" * 3000 + b"\n")


def xv11():
    def packet(index, rpm=300):
        body = struct.pack("<BBH", 0xFA, 0xA0 + index, rpm * 64)
        body += b"".join(struct.pack("<HH", (1000 + index) | (0x8000 if i == 2 else 0x4000 if i == 3 else 0), 50)
                         for i in range(4))
        total = 0
        for i in range(0, 20, 2):
            total = (total << 1) + (body[i] | body[i + 1] << 8)
        total = ((total & 0x7FFF) + (total >> 15)) & 0x7FFF
        return body + struct.pack("<H", total)

    turn = b"".join(packet(i) for i in range(90))
    seed("xv11", "turns", PIECE + turn + turn[:22 * 40] + turn[22 * 45:] + packet(3, 0) + packet(3, 600) + packet(3)[:-1] + b"\0")


def ydlidar():
    def packet(start, count, ring=False, wrong=False):
        angle = [int(64 * (start + i) % 23040) << 1 | 1 for i in (0, count - 1)]
        samples = b"".join(struct.pack("<H", (1000 + i) * 4) for i in range(count))
        head = struct.pack("<HBBHH", 0x55AA, 1 if ring else 0, count, angle[0], angle[1])
        words = struct.unpack("<%dH" % (len(head) // 2), head) + struct.unpack("<%dH" % count, samples)
        total = 0
        for word in words:
            total ^= word
        return head + struct.pack("<H", total ^ (1 if wrong else 0)) + samples

    turns = b"".join(packet(0, 1, True) + b"".join(packet(a, 30) for a in range(0, 360, 30)) for _ in range(3))
    seed("ydlidar", "turns", PIECE + turns)
    seed("ydlidar", "all_wrong", PIECE + b"".join(packet(a % 360, 8, wrong=True) for a in range(0, 800, 8)))
    answers = b"\xa5\x5a\x14\0\0\0\x04" + bytes(range(20)) + b"\xa5\x5a\x03\0\0\0\x06\0\0\0" + b"\xa5\x5a\x05\0\0\x40\x81"
    seed("ydlidar", "answers", PIECE + answers + turns[:400] + b"\xa5\x5a\xff\xff\xff\xff\x99")


# files and sockets ----------------------------------------------------------------------------------------------------


def control():
    calls = [{"method": "org.varlink.service.GetInfo"},
             {"method": "org.varlink.service.GetInterfaceDescription", "parameters": {"interface": "org.varlink.service"}},
             {"method": "org.varlink.service.GetInterfaceDescription",
              "parameters": {"interface": "org.odomcalib.Calibration"}},
             {"method": "org.varlink.service.GetInterfaceDescription", "parameters": {"interface": "org.no"}},
             {"method": "org.varlink.service.GetInterfaceDescription"},
             {"method": "org.varlink.service.No"}, {"method": "org.no.No"},
             {"method": "org.odomcalib.Calibration.No"}, {"method": "org.odomcalib.Calibration.GetStatus", "more": True},
             {"method": "a.B", "more": 1}, {"method": "a"}, {"method": "a.b"}, {"method": 5}, []]
    replies = [{"parameters": {"a": 1}, "continues": True}, {"error": "org.varlink.service.MethodNotFound"},
               {"error": "not qualified"}, {"error": 5}, {"continues": 1}, {"parameters": 5}]
    for code in ("Io", "Usage", "Device", "Timeout", "NotPermitted", "Format", "Unknown"):
        replies.append({"error": "org.odomcalib.Calibration." + code,
                        "parameters": {"what": "w", "where": "x", "remedy": "y"}})
    replies.append({"error": "org.odomcalib.Calibration.Io", "parameters": {"what": 5}})
    frames = [json.dumps(x).encode() for x in calls + replies]
    seed("control", "all", b"\xff" + b"\0".join(frames) + b"\0\0{\0" + b'{"method":"a.\xff"}\0')
    seed("control", "deep", b"\xff" + b'{"method":"a.B","parameters":{"x":' + b"[" * 40 + b"]" * 40 + b"}}\0")


def control_session():
    come, hang_up, put, call, run, renew, listen, look = range(8)
    stop, acquire, renewal, straight, spin, nudge, release, status, monitor, record, calibrate, dry, write, back = range(14)

    def act(action, client=0, much=0):
        return bytes([action | client << 3, much])

    def send(client, *frames, cut=200):
        text = b"".join(frames)
        parts = [text[i:i + cut] for i in range(0, len(text), cut)]
        return b"".join(act(put, client, len(part)) + part for part in parts)

    def frame(name, **members):
        text = json.dumps({"method": "org.odomcalib.Calibration." + name} | members).encode() + b"\0"
        return text.replace(b"\\u0001", b"\x01")  # the lease

    lengths = {"left_wheel_diameter": 0.151, "right_wheel_diameter": 0.1495, "track_width": 0.402}
    calibration = {"format": "odomcalib-calibration/1", "verdict": "accepted",
                   "parameters": {name: {"value": value, "std": 1e-5, "unit": "m"} for name, value in lengths.items()}}

    def prove(client=0):
        return send(client, frame("Apply", parameters={"lease": "\x01", "prove": True, "of_this_robot": True, "calibration": calibration}))

    def end_proof(name, client=0):
        return send(client, frame(name, parameters={"lease": "\x01"}))

    held = act(call, 0, acquire) + act(run, 0, 2)
    proving = held + prove() + act(renew, 0, 100)
    driving = held + act(call, 0, straight) + act(renew, 0, 85)
    cases = {
        "nothing": b"", "drive": driving + act(renew, 0, 60), "stop": driving + act(call, 1, stop) + act(run, 0, 20),
        "stop_then_gone": driving + act(call, 1, stop) + act(hang_up, 1) + act(renew, 0, 20),
        "silent": driving + act(run, 0, 60), "gone": driving + act(hang_up, 0) + act(run, 0, 40),
        "released": driving + act(call, 1, release) + act(run, 0, 40), "broken": driving + send(0, b"no call\0") + act(run, 0, 40),
        "both": driving + act(call, 1, straight) + act(call, 1, acquire) + act(renew, 0, 30) + act(call, 0, stop) + act(call, 0, straight),
        "spin": held + act(call, 0, spin) + act(renew, 0, 130), "nudge": held + act(call, 0, nudge) + act(renew, 0, 130),
        "calibrate": held + act(call, 0, calibrate) + act(renew, 0, 90) + act(call, 0, stop) + act(renew, 0, 20),
        "no_lease": act(call, 0, straight) + act(call, 0, 16) + act(call, 0, nudge) + act(run, 0, 100),
        "others_lease": held + act(call, 1, straight) + act(renew, 0, 85) + act(hang_up, 0) + act(run, 0, 30),
        "record": act(call, 0, record) + act(run, 0, 30) + act(call, 1, stop) + act(run, 0, 5),
        "record_gone": act(call, 0, record) + act(run, 0, 30) + act(hang_up, 0) + act(run, 0, 5),
        "monitor": act(call, 2, monitor) + act(call, 0, stop) + act(run, 0, 3) + act(call, 2, status) + act(run, 0, 3),
        "write": held + act(call, 0, write) + act(renew, 0, 100) + act(call, 0, back) + act(renew, 0, 90),
        "write_and_stop": held + act(call, 0, write) + act(renew, 0, 3) + act(call, 1, stop) + act(call, 1, write) + act(renew, 0, 50),
        "proof_stored": proving + end_proof("Store") + act(renew, 0, 100), "proof_discarded": proving + end_proof("Discard") + act(renew, 0, 100),
        "proof_gone": proving + act(hang_up, 0) + act(run, 0, 100), "proof_twice": proving + prove() + act(renew, 0, 50),
        "proof_driven": proving + act(call, 0, straight) + act(renew, 0, 85) + end_proof("Store") + act(call, 1, stop) + act(renew, 0, 40),
        "proof_gone_in_motion": held + prove(2) + act(renew, 0, 100) + act(call, 0, straight) + act(renew, 0, 85) + act(hang_up, 2) +
                                act(renew, 0, 120),
        "proof_of_others": proving + end_proof("Store", 1) + end_proof("Discard", 3) + act(call, 0, write) + act(renew, 0, 50),
        "no_proof": held + end_proof("Store") + end_proof("Discard") + act(run, 0, 20),
        "many": b"".join(act(come, i) for i in range(12)) + act(run, 0, 1) + b"".join(act(call, i, status) for i in range(12)) +
                act(run, 0, 1) + b"".join(act(come, i) + act(call, i, stop) for i in (0, 9, 11)) + act(run, 0, 2),
        "many_in_motion": driving + b"".join(act(call, i, status) for i in range(1, 12)) + act(renew, 0, 2) + act(call, 11, stop),
        "burst": act(look, 0, 1) + b"".join(act(call, i % 3, status) for i in range(60)) + act(call, 4, stop) + act(run, 0, 30),
        "burst_and_stop": driving + b"".join(act(call, 1, status) for i in range(120)) + act(call, 1, stop) + act(renew, 0, 20),
        "deaf": act(call, 0, monitor) + act(listen, 0, 1) + b"".join(act(call, 0, 17) for i in range(30)) + act(run, 0, 30) +
                act(listen, 0, 0) + act(run, 0, 5),
        "pieces": send(0, frame("GetStatus"), frame("Stop"), frame("Check", parameters={"nudge": 1}), cut=7) + act(run, 0, 2),
        "escaped": driving + send(1, b'{"method":"org.odomcalib.Calibration.S\\u0074op"}\0') + act(renew, 0, 20),
        "oneway": send(0, frame("Acquire", oneway=True), frame("Straight", oneway=True, parameters={"lease": "\x01", "distance": 1})) +
                  act(run, 0, 9),
        "services": send(0, *(frame(name)[:-1].replace(b"org.odomcalib.Calibration", b"org.varlink.service") + b"\0"
                              for name in ("GetInfo", "GetInterfaceDescription", "No"))) + act(run, 0, 2),
        "wrong": send(0, frame("Straight", parameters={"distance": "x"}), frame("Straight", parameters={"distance": None}),
                      frame("Spin", parameters={"turns": -1}), frame("Record", parameters={"name": "../x", "duration": -1}),
                      frame("Apply", parameters={"calibration": {}}), frame("History", parameters={"limit": -1}),
                      frame("Renew", parameters={"lease": None, "sent": "now"}), frame("No"), frame("Monitor")) + act(run, 0, 3),
        "rubbish": send(0, frame("GetStatus"), b"\0\0{\0") + send(1, b"[" * 90 + b"\0") + send(2, b"\xff" * 9) + act(run, 0, 3) +
                   act(call, 0, stop) + act(call, 1, stop) + act(call, 2, stop) + act(run, 0, 3),
    }
    for name, records in cases.items():
        seed("control_session", name, records)


def event(number, channel, data, length=None):
    size = len(data) if length is None else length
    return b"\xed\xa1\xda\x01" + struct.pack(">QQII", number, 1700000000000000 + 10000 * number, len(channel), size) + channel + data


def lcm_log():
    whole = event(1, b"A", b"123") + event(2, b"B", b"x" * 50)
    # The harness puts the first four bytes itself.
    seed("lcm_log", "damaged", (whole + event(3, b"C", b"y" * 30, 0x7FFFFFFF) + whole + b"garbage" + whole)[4:])
    seed("lcm_log", "damaged_then_cut", (whole + event(3, b"", b"y") + whole + event(4, b"D", b"z" * 99)[:60])[4:])
    seed("lcm_log", "cut_in_header", (whole + b"noise" + event(4, b"D", b"z")[:14])[4:])
    seed("lcm_log", "cut", (whole + event(4, b"D", b"z" * 99)[:60])[4:])
    seed("lcm_log", "noise_then_cut", (whole + b"noise" + event(4, b"D", b"z" * 99)[:60])[4:])


def pose_graph():
    two = "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0\n"
    edge = "1 0 0 1 0 0 1 0 1\n"
    cases = {
        "twice": two + "VERTEX_SE2 1 0 0 0\n", "unknown": two + "EDGE_SE2 0 2 " + edge, "self": two + "EDGE_SE2 1 1 " + edge,
        "nan": two + "EDGE_SE2 0 1 nan 0 0 1 0 0 1 0 1\n", "half": two + "EDGE_SE2 0 1.5 " + edge,
        "short": two + "EDGE_SE2 0 1 1 0", "long": two + "EDGE_SE2 0 1 " + edge[:-1] + " 7\n",
        "kind": two + "EDGE_SE2_XY 0 1 1 0 1 0 1\n", "fix": two + "FIX 0 1\nFIX\n", "fix_unknown": two + "FIX 5\n",
        "spatial": "VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\n", "nothing": "", "remarks": "# a\n\nPARAMS 1\nPARAMS 2\n" + two,
        "edges_only": "EDGE_SE2 5 9 1 0 0 10 1 2 20 3 30\nEDGE_SE2_XY 5 20 1 0 1 0 1\n",
        "information": two + "EDGE_SE2 0 1 1 0 0 20 0 20 100000 0 0\n",
        "negative": two + "EDGE_SE2 0 1 1 0 0 -1 0 0 1 0 1\n",
        "good": two + "VERTEX_XY 9 1 1\nFIX 0\nEDGE_SE2 0 1 1 0 0 10 1 2 20 3 30\nEDGE2 1 0 1 0 0 10 1 20 30 2 3\n"
                "EDGE_SE2_XY 1 9 1 0 1 0 1\nEDGE 0 1 1 0 0 10 1 20 30 2 3\nVERTEX2 12 0 0 0\nVERTEX 13 0 0 0\n",
    }
    for name, text in cases.items():
        seed("pose_graph", name, text)


def recordings():
    robot = {"type": "robot", "wheel_diameter": 0.1, "track_width": 0.3, "ticks_per_rev": 1000}
    ticks = "".join(json.dumps({"type": "ticks", "t": t, "left": 10 * i, "right": 9 * i}) + "\n"
                    for i, t in enumerate((0, 0.1, 0.2, 50, 0.3, 0.4, 1.5, 0.1, 1.6, 1e300)))
    odd = "".join(line + "\n" for line in (
        '{"type":"ticks","t":2,"left":9223372036854775807,"right":1}', '{"type":"ticks","left":1,"right":1}',
        '{"type":"ticks","t":2.1,"left":1.5,"right":1}', '{"type":"pose","t":2,"x":1,"y":null,"yaw":0}',
        '{"type":"pose","t":2,"x":1,"y":2,"yaw":0.5}', '{"type":"gyro","t":2,"yaw_rate":null}',
        '{"type":"gyro","t":2,"yaw_rate":0.5}', '{"type":"scan","t":2,"angle_min":0,"angle_increment":0.1,"ranges":[1,2]}',
        '{"type":"scan","t":2.1,"angles":[0.1],"ranges":[1,2]}', '{"type":"scan","t":2.2,"angles":[0.1,0.2],"ranges":[1,-2]}',
        '{"type":"scan","t":2.3,"angles":[0.1,0.2,0.3],"times":[0.02,0.01,0.03],"ranges":[1,2,3],"intensities":[7,8,9]}',
        '{"type":"scan","t":2.4,"angle_min":0,"angle_increment":0.1,"time_increment":-1,"ranges":[1,2]}',
        '{"type":"noise"}', '{}', '[1]', '{"type":"robot","wheel_diameter":0.2,"track_width":0.3,"ticks_per_rev":1000}',
        '{"type":"robot","left_wheel_diameter":0.1,"right_wheel_diameter":0.11,"track_width":0.3,"ticks_per_rev":1000,'
        '"lidar_pose":[1,2,3]}'))
    seed("jsonl", "odd", ticks + odd)
    seed("recording", "gzip", gzip.compress((json.dumps(robot) + "\n" + ticks + odd).encode(), mtime=0))
    seed("recording", "nothing", b"")
    seed("recording", "unknown", b"what is this?\n")
    seed("recording", "unknown_bytes", bytes(range(256)))
    seed("recording", "late_json", ("rubbish\n" + json.dumps(robot) + "\n" + ticks))
    seed("recording", "cut_gzip", gzip.compress((json.dumps(robot) + "\n" + ticks).encode(), mtime=0)[:-20])
    for name, change in {"no_track": {"track_width": 0}, "negative": {"track_width": -1}, "huge": {"ticks_per_rev": 1e30},
                         "wide": {"wheel_diameter": 1e9}, "zero_ticks": {"ticks_per_rev": -5}}.items():
        seed("recording", "robot_" + name, json.dumps({**robot, **change}) + "\n" + ticks)
    for kind in ("wheels", "wheel_speeds", "odometry"):
        lines = "".join(json.dumps({"type": kind, "t": 0.1 * i, "left": 0.1 * i, "right": 0.2 * i, "x": 0.1 * i, "y": 0.0,
                                    "yaw": 0.01 * i}) + "\n" for i in range(9))
        seed("recording", kind, json.dumps(robot) + "\n" + lines)


# ROS recordings ---------------------------------------------------------------------------------------------------------


def ros_text(text, cdr):
    return struct.pack("<I", len(text) + cdr) + text.encode() + b"\0" * cdr


def ros_message(kind, k, cdr):
    """Message number k as ROS 1 or CDR has it. All fields are multiples of four bytes up to the first number of eight."""
    time = struct.pack("<II", 1000, 20_000_000 * k)
    head = (b"\0\1\0\0" + time if cdr else struct.pack("<I", k) + time) + ros_text("abc", cdr)

    def numbers(*values):
        start = len(head) - 4 if cdr else 0
        return b"\0" * (-start % 8 if cdr else 0) + struct.pack("<%dd" % len(values), *values)

    if kind == "scan":
        return head + struct.pack("<7fI3fI", 0, 1, 0.5, 0.001, 0, 0.1, 9, 3, 1, float("inf"), 2, 0)
    if kind == "joints":
        names = struct.pack("<I", 2) + ros_text("left", cdr) + b"\0" * (3 * cdr) + ros_text("right", cdr)
        body = head + names
        pad = b"\0" * (-len(body) % 4 if cdr else 0)
        body += pad + struct.pack("<I", 2)
        body += b"\0" * (-(len(body) - 4) % 8 if cdr else 0)
        return body + struct.pack("<2dII", 0.1 * k, 0.2 * k, 0, 0)
    if kind == "imu":
        return head + numbers(*[0.0] * 15, 0.5, *[0.0] * 21)
    if kind == "odometry":
        child = ros_text("bas", cdr)
        start = len(head) + len(child) - 4
        return head + child + b"\0" * (-start % 8 if cdr else 0) + struct.pack("<85d", 0.1 * k, 0, 0, 0, 0, 0, 1, *[0.0] * 78)
    return head + numbers(0.1 * k, 0, 0, 0, 0, 0, 1)


ROS_TYPES = {"scan": "sensor_msgs/LaserScan", "joints": "sensor_msgs/JointState", "imu": "sensor_msgs/Imu",
             "odometry": "nav_msgs/Odometry", "pose": "geometry_msgs/PoseStamped"}


def lz4_frame(data):
    """One block that is not compressed; 0x82 is the checksum of these two descriptor bytes."""
    return b"\x04\x22\x4d\x18\x60\x40\x82" + struct.pack("<I", len(data) | 1 << 31) + data + bytes(4)


def zstd_frame(data):
    """One block that is not compressed, behind a header with the size in four bytes."""
    return b"\x28\xb5\x2f\xfd\xa0" + struct.pack("<I", len(data)) + struct.pack("<I", len(data) << 3 | 1)[:3] + data


def rosbag():
    def sized(data):
        return struct.pack("<I", len(data)) + data

    def record(data, **fields):
        return sized(b"".join(sized(k.encode() + b"=" + v) for k, v in fields.items())) + sized(data)

    def number(value):
        return struct.pack("<I", value)

    records = b""
    for conn, (kind, name) in enumerate(ROS_TYPES.items()):
        about = b"".join(sized(f) for f in (b"topic=/" + kind.encode(), b"type=" + name.encode(), b"md5sum=*"))
        records += record(about, op=b"\7", conn=number(conn), topic=b"/" + kind.encode())
        for k in range(3):
            records += record(ros_message(kind, k, 0), op=b"\2", conn=number(conn), time=struct.pack("<II", 1000, k))
    size = number(len(records))
    begin = record(b"  ", op=b"\3", index_pos=bytes(8), conn_count=number(5), chunk_count=number(1))
    index = record(bytes(12), op=b"\4", ver=number(1), conn=number(0), count=number(1))
    for name, packed in (("none", records), ("bz2", bz2.compress(records)), ("lz4", lz4_frame(records))):
        chunk = record(packed, op=b"\5", compression=name.encode(), size=size)
        seed("rosbag", name, begin + chunk + index)
    seed("rosbag", "no_chunk", begin + records)
    seed("rosbag", "packing", begin + record(records, op=b"\5", compression=b"zip", size=size))
    seed("rosbag", "encrypted", record(b"", op=b"\3", encryptor=b"x"))
    seed("rosbag", "no_op", begin + record(b"x"))
    seed("rosbag", "strangers", begin + record(b"", op=b"\2", conn=number(9), time=bytes(8)) + record(b"", op=b"\7"))


def mcap_text(value):
    return struct.pack("<I", len(value)) + value.encode()


def mcap_record(op, data):
    return bytes([op]) + struct.pack("<Q", len(data)) + data


def mcap_topic(i, name, kind, count=3, cdr=1, change=lambda message: message, type_name=None):
    """Schema, channel and messages of one topic."""
    type_name = type_name or ROS_TYPES[kind]
    schema = type_name.replace("/", "/msg/") if cdr else type_name
    out = mcap_record(3, struct.pack("<H", i) + mcap_text(schema) + mcap_text("ros2msg") + mcap_text(""))
    out += mcap_record(4, struct.pack("<HH", i, i) + mcap_text(name) + mcap_text("cdr" if cdr else "ros1") + mcap_text(""))
    for k in range(count):
        out += mcap_record(5, struct.pack("<HIQQ", i, k, 10**12 + k, 0) + change(ros_message(kind, k, cdr)))
    return out


def mcap_topics(begin):
    """Choices that a reader of several topics has to make."""
    def whole(*topics):
        return begin + b"".join(mcap_topic(i, *topic) for i, topic in enumerate(topics, 1))

    scan, joints, odometry, imu, pose = (("/" + kind, kind) for kind in ("scan", "joints", "odometry", "imu", "pose"))
    seed("mcap", "two_scans", whole(scan, ("/rear", "scan"), joints))
    seed("mcap", "two_odometries", whole(scan, odometry, ("/odom", "odometry")))
    seed("mcap", "odometry_decides", whole(scan, odometry))
    seed("mcap", "two_gyros", whole(scan, joints, imu, ("/imu2", "imu")))
    seed("mcap", "poses_for_scans", whole(joints, pose))
    seed("mcap", "no_view", whole(joints))
    seed("mcap", "many", whole(*(("/t%d" % i, "imu", 1) for i in range(20)), scan, ("/rear", "scan")))
    # Names and numbers of the same length, so that the message stays whole.
    named = {"elbows": (b"right\0", b"elbow\0"), "wheels": (b"left\0", b"lft_\0")}
    for name, (old, new) in named.items():
        seed("mcap", name, whole(scan, ("/joints", "joints", 3, 1, lambda m, o=old, n=new: m.replace(o, n))))
    seed("mcap", "unstamped", whole(("/scan", "scan", 3, 1, lambda m: m[:4] + bytes(8) + m[12:]), joints))
    seed("mcap", "two_clocks", whole(("/scan", "scan", 3, 1, lambda m: m[:4] + struct.pack("<I", 5000) + m[8:]), joints))
    seed("mcap", "foreign", whole(scan, joints, ("/x", "imu", 2, 1, lambda m: m, "std_msgs/String")))
    speeds = struct.pack("<2d", 0.1, 0.2)
    seed("mcap", "speeds", whole(scan, ("/joints", "joints", 3, 1, lambda m: joint_speeds(m, speeds))))


def joint_speeds(message, speeds):
    """The same joints with speeds in place of positions: no positions, two speeds, no efforts."""
    head = message[:-28]  # count of positions with its padding, two positions, two empty lists
    return head + struct.pack("<II", 0, 2) + speeds + struct.pack("<I", 0)


def mcap():
    text, record = mcap_text, mcap_record

    def records(cdr):
        return b"".join(mcap_topic(i, "/" + kind, kind, cdr=cdr) for i, kind in enumerate(ROS_TYPES, 1))

    def chunk(name, packed, whole, crc=0):
        return record(6, struct.pack("<QQQI", 0, 9, len(whole), crc) + text(name) + struct.pack("<Q", len(packed)) + packed)

    end = record(15, bytes(4)) + record(2, bytes(20)) + b"\x89MCAP0\r\n"
    begin = record(1, text("ros2") + text("seed"))
    plain = records(1)
    seed("mcap", "no_chunk", begin + plain + end)
    seed("mcap", "ros1", begin + chunk("", records(0), records(0), zlib.crc32(records(0))) + end)
    seed("mcap", "lz4", begin + chunk("lz4", lz4_frame(plain), plain) + end)
    seed("mcap", "zstd", begin + chunk("zstd", zstd_frame(plain), plain) + end)
    seed("mcap", "crc", begin + chunk("", plain, plain, 1) + end)
    seed("mcap", "packing", begin + chunk("zip", plain, plain) + end)
    mcap_topics(begin)
    magic = b"\x89MCAP0\r\n"
    for name, file in (("whole", magic + begin + plain + end), ("nonsense", b"no recording at all"), ("empty", b"")):
        seed("recording", "zstd_" + name, zstd_frame(file))
    seed("recording", "zstd_cut", zstd_frame(magic + begin + plain + end)[:-400])
    seed("recording", "zstd_broken", b"\x28\xb5\x2f\xfd" + b"\xff" * 20)
    seed("recording", "old_bag", b"#ROSBAG V1.2\n")
    seed("recording", "rosrecord", b"#ROSRECORD V1.1\n")
    seed("mcap", "strangers", begin + record(5, struct.pack("<HIQQ", 9, 0, 0, 0)) + record(4, b"x") + record(5, b"x"))


def rosbag2():
    def database(sql, rows=()):
        with tempfile.NamedTemporaryFile(suffix=".db3") as file:
            with sqlite3.connect(file.name) as connection:
                connection.executescript("PRAGMA page_size=512;" + sql)
                if rows:
                    connection.executemany("INSERT INTO messages(topic_id, timestamp, data) VALUES(?, ?, ?)", rows)
            connection.close()
            return pathlib.Path(file.name).read_bytes()[16:]  # the harness puts the magic in front

    kinds = list(ROS_TYPES)
    tables = "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT);" \
        "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB);"
    topics = "".join("INSERT INTO topics VALUES(%d, '/%s', '%s', 'cdr');" % (i, kind, ROS_TYPES[kind].replace("/", "/msg/"))
                     for i, kind in enumerate(kinds, 1))
    rows = [(i, k, ros_message(kind, k, 1)) for kind, i in (("scan", 1), ("joints", 2), ("imu", 3), ("pose", 5)) for k in range(2)]
    seed("rosbag2", "plain", database(tables + topics, rows))
    seed("rosbag2", "packed", database(tables + topics, [(i, k, zstd_frame(data)) for i, k, data in rows]))
    seed("rosbag2", "cut", database(tables + topics, rows)[:-700])
    seed("rosbag2", "strangers", database(tables, [(9, 1, b"x"), (1, None, None)]))
    view = "CREATE TABLE n(topic_id, timestamp, data); CREATE VIEW messages AS SELECT * FROM n;"
    seed("rosbag2", "view", database(tables.split(";")[0] + ";" + view))


def ros_messages():
    for number, kind in enumerate(ROS_TYPES):
        for cdr in (0, 1):
            seed("ros_messages", kind + ("_cdr" if cdr else "_ros1"), bytes([2 * number + cdr]) + ros_message(kind, 3, cdr))
    urdf = ('<robot><joint name="a" type="fixed"><parent link="base_link"/><child link="laser"/>'
            '<origin xyz="0.1 0 0" rpy="0 0 1.5"/></joint></robot>')
    for cdr in (0, 1):
        text = (b"\0\1\0\0" if cdr else b"") + ros_text(urdf, cdr)
        seed("ros_messages", "description" + ("_cdr" if cdr else "_ros1"), bytes([12 + cdr]) + text)


def profiles():
    good = (CORPUS / "profile" / "sim-dual.toml").read_text()
    pair = (CORPUS / "profile" / "cia402-pair.toml").read_text()
    arcos_text = (CORPUS / "profile" / "arcos.toml").read_text()

    def changed(text, old, new):
        assert old in text, old
        return text.replace(old, new, 1)

    cases = {
        "node": changed(good, "node = 1", "node = 999"), "node_text": changed(good, "node = 1", 'node = "x"'),
        "no_node": changed(good, "node = 1\n", ""), "syntax": changed(good, "node = 1", "node = = 1"),
        "style": changed(good, '"dual-axis"', '"odd"'), "protocol": changed(good, '"canopen"', '"odd"'),
        "object": changed(good, '"6064:01"', '"606G:01"'), "type": changed(good, '"u32"', '"u33"'),
        "quantity": changed(good, '"track_width"', '"trackwidth"'), "unmapped": changed(good, '"6064:01/32"', '"6063:01/32"'),
        "entry": changed(good, '"6064:01/32"', '"6064:01/33"'), "unmapped_rpdo": changed(good, '"60FF:01/32"', '"60FE:01/32"'),
        "watchdog": changed(good, 'kind = "1016"', 'kind = "odd"'),
        "watchdog_none": changed(good, 'kind = "1016"', 'kind = "none"'),
        "watchdog_object": changed(good, 'kind = "1016"', 'kind = "object"\nobject = "2000:00"\ntype = "u16"'),
        "name": changed(good, 'name = "sim-dual"', "name = 5"), "array": changed(good, "node = 1", "node = [1, 2]"),
        "value": changed(good, "value = 3 ", "value = 300000 "),
        "pair_quantity": pair + '\n[[profile.parameter]]\nquantity = "track_width"\nobject = "6092:01"\n',
        "pair_formula": pair + '\n[[profile.parameter]]\nquantity = "wheel_diameter"\nobject = "6092:01"\nformula = "odd"\n',
        "pair_verify": pair + '\n[profile.store]\nverify = "odd"\n',
        "arcos_no_width": arcos_text.replace("track_width", "track_widht"),
        "arcos_watchdog": arcos_text.replace('kind = "builtin"', 'kind = "odd"'),
        "arduino": '[profile]\nname = "a"\nprotocol = "ros_arduino"\n[profile.ticks]\ncounts_per_rev = 100\n',
        "same_node": '[profile]\nname = "v"\nprotocol = "vesc"\nnode = 3\nleft = 1\nright = 1\n',
    }
    for name, text in cases.items():
        seed("profile", name, text)


# configuration --------------------------------------------------------------------------------------------------------


def config():
    good = (CORPUS / "config" / "odomcalib.toml").read_text()
    robot = (CORPUS / "config" / "robot.toml").read_text()

    def changed(text, old, new):
        assert old in text, old
        return text.replace(old, new, 1)

    cases = {
        "syntax": changed(good, "speed = 0.30", "speed = = 0.30"), "text": changed(good, '"ld06"', "6"),
        "flag": changed(good, "enabled = true", 'enabled = "true"'), "pose": changed(good, "[0.10, 0.0, 0.0]", "[0.10, nan, 0.0]"),
        "pose_short": changed(good, "[0.10, 0.0, 0.0]", "[0.10, 0.0]"), "range": changed(good, "speed = 0.30", "speed = 1e3"),
        "infinite": changed(good, "track_width = 0.400", "track_width = -inf"),
        "sides": changed(good, "wheel_diameter = 0.150", "left_wheel_diameter = 0.15\nright_wheel_diameter = 0.149"),
        "near": changed(good, "track_width", "track_widht"), "elsewhere": changed(good, "track_width = 0.400", "") + "track_width = 0.4\n",
        "foreign": changed(good, "track_width", "wheelbase"), "whole": "limits.countdown = 0\n[robot]\ntrack_width = 1\n",
        "quoted": '"robot.track_width" = 0.4\n[robot]\nid = "a"\n', "unnamed": '"" = {robot = {track_width = 0.4}}\n[robot]\nid = "a"\n',
        "tables": "[[robot]]\ntrack_width = 0.4\n", "sections": "[other]\n[robot.inner]\n[limits]\n",
        "robot_section": '[robot]\nticks_per_rev = 4096\nlidar_pose = [0.1, 0, 0]\nrobot_id = "a"\n[lidar]\npose = [0, 0, 1]\n',
        "robot_radius": changed(robot, "wheel_diameter = 0.150", "wheel_radius = 0.075"), "robot_nothing": "\n",
        "robot_ticks": changed(robot, "16384", "1e10"), "robot_id": changed(robot, '"robot-1"', "1"),
        "robot_foreign": "[robot]\ncpr = 4096\n", "bytes": b'robot_id = "\xff"\n',
    }
    for name, text in cases.items():
        seed("config", name, text)


# write-back -----------------------------------------------------------------------------------------------------------


def journal():
    def record(number, step, **members):
        body = {"after": {"track_width": 0.41}, "before": {"track_width": 0.4}, "label": "apply", "monotonic": 1.5,
                "seq": number, "state": step, "wall_us": 7}
        return "________ " + json.dumps(body | members) + "\n"

    states = ["begin", "write", "readback_ok", "store_begin", "store_ok", "commit", "rollback", "rolled_back", "needs_operator"]
    whole = "".join(record(i + 1, state, device="d", calibration="none", store_begun=i > 2) for i, state in enumerate(states))
    seed("journal", "empty", b"\x00")
    seed("journal", "states", "\x00" + whole)
    for i, state in enumerate(states):
        seed("journal", state, chr(i) + record(9, state))
    seed("journal", "torn", "\x01" + record(1, "begin") + record(2, "write")[:-20])
    seed("journal", "damaged", "\x02" + record(1, "begin") + record(2, "write").replace("________", "deadbeef"))
    seed("journal", "noise", b"\x03\x00\xff\n\n" + record(1, "commit").encode() + b"\xfe\n\x00")
    odd = [{"seq": -1}, {"seq": 1.5}, {"seq": 1e300}, {"seq": 2 ** 64 - 1}, {"seq": 2 ** 70}, {"seq": "1"}, {"monotonic": None},
           {"monotonic": True}, {"wall_us": -1e300}, {"wall_us": 2 ** 63}, {"state": "other"}, {"state": 1}, {"label": None},
           {"before": []}, {"before": {"a": "b"}}, {"after": {"a": 5e-324, "": -0.0}}, {"device": 5}, {"calibration": "\x00"},
           {"store_begun": 1}, {"label": "\u00e4\ud83d\ude00"}]
    for i, members in enumerate(odd):
        seed("journal", "odd_%02d" % i, "\x04" + record(1, "begin") + record(2, "write", **members))


# network captures -----------------------------------------------------------------------------------------------------


def packet(data, sequence=1, acknowledged=0, flags=0x10, ports=(2112, 40000), v6=False, protocol=6, fragment=0):
    tcp = struct.pack(">HHIIBBHHH", *ports, sequence, acknowledged, 0x50, flags, 4096, 0, 0) + data
    if v6:
        return struct.pack(">IHBB", 0x60000000, len(tcp), protocol, 64) + bytes(range(32)) + tcp
    return struct.pack(">BBHHHBBH8s", 0x45, 0, 20 + len(tcp), 0, fragment, 64, protocol, 0, bytes(range(8))) + tcp


def capture(link, *frames):
    head = struct.pack("<IHHIIII", 0xA1B2C3D4, 2, 4, 0, 0, 65535, link)
    return head + b"".join(struct.pack("<IIII", 0, 0, len(f), len(f)) + f for f in frames)


def ethernet(data, kind=0x0800, tags=b""):
    return bytes(12) + tags + struct.pack(">H", kind) + data


def network_captures():
    two = packet(b"abc"), packet(b"def", 4)
    out_of_order = [ethernet(packet(b"", 0, flags=2)), ethernet(packet(b"def", 4)), ethernet(packet(b"abc")),
                    ethernet(packet(b"bcd", 2)), ethernet(packet(b"x", 90)),
                    ethernet(packet(b"", 1, 91, ports=(40000, 2112)))]
    seed("network_capture", "ethernet", capture(1, *out_of_order))
    seed("network_capture", "vlan", capture(1, *(ethernet(p, tags=bytes.fromhex("81000005")) for p in two)))
    seed("network_capture", "v6", capture(1, ethernet(packet(b"abc", v6=True), 0x86DD)))
    seed("network_capture", "raw", capture(101, *two))
    seed("network_capture", "cooked", capture(113, *(bytes(14) + b"\x08\x00" + p for p in two)))
    seed("network_capture", "cooked2", capture(276, *(b"\x08\x00" + bytes(18) + p for p in two)))
    seed("network_capture", "null", capture(0, *(b"\x02\0\0\0" + p for p in two)))
    seed("network_capture", "others", capture(1, ethernet(packet(b"a", protocol=17)), ethernet(packet(b"a", fragment=0x2000)),
                                              ethernet(b"", 0x0806), ethernet(packet(b"abc")[:30])))
    seed("network_capture", "no_ip", capture(201, b"abc"))
    seed("network_capture", "cut", capture(1, *out_of_order)[:-3])
    section = struct.pack("<IIIHHqI", 0x0A0D0D0A, 28, 0x1A2B3C4D, 1, 0, -1, 28)
    interface = struct.pack("<IIHHII", 1, 20, 1, 0, 65535, 20)
    frame = ethernet(packet(b"abc"))
    padded = frame + bytes(-len(frame) % 4)
    block = struct.pack("<IIIIIII", 6, 32 + len(padded), 0, 0, 0, len(frame), len(frame)) + padded
    seed("network_capture", "pcapng", section + interface + block + struct.pack("<I", 32 + len(padded)))

    def step(what, at, data=b""):
        return bytes([what]) + struct.pack("<H", at) + bytes([len(data)]) + data

    seed("tcp_stream", "order", step(1, 9) + step(4, 13, b"def") + step(4, 10, b"abc") + step(4, 11, b"bcdefg") + step(3, 0))
    seed("tcp_stream", "gap", step(4, 10, b"abc") + step(4, 20, b"def") + step(2, 23) + step(4, 13, b"late"))
    seed("tcp_stream", "far", step(4, 10, b"abc") + step(255, 10, b"x") * 4 + step(2, 60))
    seed("tcp_stream", "anew", step(1, 9) + step(4, 10, b"abc") + step(4, 30, b"x") + step(1, 500) + step(4, 501, b"d"))


# Library --------------------------------------------------------------------------------------------------------------


def odometry():
    def calibration(effects, **members):
        names = ("left_wheel_diameter", "right_wheel_diameter", "track_width", "lidar_x", "lidar_y", "lidar_yaw")
        parameters = {name: {"value": 0.15, "std": 1e-4, "unit": "rad" if name == "lidar_yaw" else "m"} for name in names}
        listed = [{"name": name, "stored_in": "host", "aliases": [],
                   "parameters": {key: {"value": value, "std": 1e-3, "unit": "1"} for key, value in values.items()},
                   "evidence": {"p_value": 0.01, "held_out_before": None, "held_out_after": None}}
                  for name, values in effects.items()]
        noise = {axis: {"value": 0.002, "unit": "m"} for axis in ("forward", "sideways", "yaw")}
        return json.dumps({"format": "odomcalib-calibration/1", "verdict": "accepted", "robot": {"ticks_per_rev": 4096},
                           "parameters": parameters, "effects": listed, "contact_noise": noise,
                           "covariance": {"order": names[:1], "matrix": [[1e-8]]}, **members}).encode()

    def steps(count, first=0):
        return b"".join(bytes([7, 20]) + struct.pack("<hh", 40 * k, (30 if k % 60 < 30 else -10) * (k % 30))
                        for k in range(first, first + count))

    many = {"backlash": {"left_play": 0.05, "right_play": 0.05, "spread": 0.0},
            "caster_kick": {"kappa": 0.01, "kappa_turn": 0.01, "kappa_side": 0.01, "length": 0.08, "order": 0.0, "lean": 0.0},
            "stop_settling": {"turn": 0.005, "way": 0.005, "lasting": 0.0, "speed": 0.0},
            "acceleration_slip": {"k": 0.01, "side": 0.0}, "time_offset": {"offset": 0.02, "smoothing": 0.001},
            "wheel_eccentricity": {"left_cos": 0.005, "left_sin": 0.005}, "carpet": {"p_x": 0.01, "p_y": 0.0},
            "range_bias": {"offset": 0.01}, "lidar_tilt": {"angle": 0.05, "direction": 0.3}, "of_tomorrow": {"k": 1.0}}
    curve = {"variable": "previous_push", "carrier": "both_travel", "low": -1.0, "high": 1.0, "memory": 10, "coefficients": [0.01]}
    seed("odometry", "plain", b"\0" + calibration({}) + b"\0" + steps(40))
    seed("odometry", "effects", b"\0" + calibration(many) + b"\0" + steps(100) + bytes([5, 0]) + struct.pack("<ff", 0.3, 2.0))
    seed("odometry", "curve", b"\0" + calibration({}, curves=[curve]) + b"\0" + steps(40))
    seed("odometry", "wraps", b"\x10" + calibration({}) + b"\0" + steps(10) + bytes([7, 20]) + struct.pack("<hh", -32768, 32767))
    jump = bytes([0, 20]) + struct.pack("<qq", 1 << 52, -(1 << 52))
    seed("odometry", "jump", b"\0" + calibration({}) + b"\0" + steps(5) + jump + steps(2, 5) + jump + jump + bytes([3, 0]) + steps(3))
    late = bytes([0x80]) + struct.pack("<dqq", -5.0, 100, 100)
    seed("odometry", "stamps", b"\0" + calibration({}) + b"\0" + steps(5) + late + bytes([0x80]) + struct.pack("<dqq", float("nan"), 0, 0)
         + late + bytes([0x80]) + struct.pack("<dqq", -4.9, 110, 110))
    turns = b"".join(bytes([1, 20]) + struct.pack("<dd", 0.1 * k, 0.12 * k) for k in range(20))
    seed("odometry", "angles", b"\0" + calibration(many) + b"\0" + turns + bytes([4, 0]) + struct.pack("<ddd", 1.0, 2.0, 9.0) + turns)
    seed("odometry", "speeds", b"\0" + calibration({}) + b"\0" + b"".join(bytes([2, 20]) + struct.pack("<dd", 3.0, 2.0) for _ in range(9)))
    path = b"".join(struct.pack("<hhq", 20 * k, 50 * k, 40 * k) for k in range(30))
    seed("odometry", "path", b"\0" + calibration(many) + b"\0" + bytes([6, 0]) + path)
    seed("odometry", "none", b"\0{}\0")


if __name__ == "__main__":
    for make in (candump, slcan, sdo, speed_can, speed_serial, ld06, rplidar, cola, scip, xv11, ydlidar, control, control_session, lcm_log,
                 pose_graph, recordings, rosbag, mcap, rosbag2, ros_messages, profiles, config, journal, network_captures, odometry):
        make()
