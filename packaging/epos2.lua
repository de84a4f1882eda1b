-- Wireshark dissector of the serial protocol of maxon's EPOS2, as velomotion's logs hold it: LINKTYPE_USER0 with USB
-- frames, or with the bytes of one read or write on RS232. Source: EPOS2 Communication Guide (2016), chapters USB and RS232.
--
--   tshark -X lua_script:epos2.lua -r scan.pcapng -Y epos2
--   cp epos2.lua ~/.local/lib/wireshark/plugins/        # for every start of Wireshark and tshark

local epos2 = Proto("epos2", "EPOS2 serial protocol")

local commands = {
  [0x00] = "Answer", [0x0E] = "Send NMT Service", [0x10] = "Read Object", [0x11] = "Write Object",
  [0x12] = "Initiate Segmented Read", [0x13] = "Initiate Segmented Write", [0x14] = "Segmented Read",
  [0x15] = "Segmented Write", [0x20] = "Send CAN Frame", [0x21] = "Request CAN Frame",
}
-- Name and width in bits of objects, negative where signed. Above its width a drive answers with anything.
local objects = {
  [0x1001] = { "Error Register", 8 }, [0x1003] = { "Error History", 32 }, [0x1008] = { "Device Name" },
  [0x1018] = { "Identity", 32 }, [0x2028] = { "Velocity Actual Value Averaged", -32 },
  [0x2070] = { "Digital Input Configuration", 16 }, [0x2071] = { "Digital Input Functionalities", 16 },
  [0x2078] = { "Digital Output Functionalities", 16 }, [0x2079] = { "Digital Output Configuration", 16 },
  [0x2081] = { "Home Position", -32 }, [0x6040] = { "Controlword", 16 }, [0x6041] = { "Statusword", 16 },
  [0x6060] = { "Modes of Operation", -8 }, [0x6061] = { "Modes of Operation Display", -8 },
  [0x6062] = { "Position Demand Value", -32 }, [0x6064] = { "Position Actual Value", -32 },
  [0x6065] = { "Maximal Following Error", 32 }, [0x606C] = { "Velocity Actual Value", -32 },
  [0x6078] = { "Current Actual Value", -16 }, [0x607A] = { "Target Position", -32 }, [0x607C] = { "Home Offset", -32 },
  [0x607D] = { "Software Position Limit", -32 }, [0x607F] = { "Maximal Profile Velocity", 32 },
  [0x6081] = { "Profile Velocity", 32 }, [0x6083] = { "Profile Acceleration", 32 },
  [0x6084] = { "Profile Deceleration", 32 }, [0x6085] = { "Quick Stop Deceleration", 32 }, [0x6098] = { "Homing Method", -8 },
}
-- Objects with several values, whose subindex 0 is their number, 8 bits.
local several = { [0x1003] = true, [0x1018] = true, [0x2070] = true, [0x2071] = true, [0x2078] = true, [0x2079] = true, [0x607D] = true }
-- Of these commands, the first two data words name an object.
local with_object = { [0x10] = true, [0x11] = true, [0x12] = true, [0x13] = true }

local f = {
  opcode = ProtoField.uint8("epos2.opcode", "Opcode", base.HEX, commands),
  words = ProtoField.uint8("epos2.words", "Data words", base.DEC),
  index = ProtoField.uint16("epos2.index", "Index", base.HEX),
  name = ProtoField.string("epos2.object", "Object"),
  subindex = ProtoField.uint8("epos2.subindex", "Subindex", base.HEX),
  node = ProtoField.uint8("epos2.node", "Node", base.DEC),
  error = ProtoField.uint32("epos2.error", "Error", base.HEX),
  value = ProtoField.int64("epos2.value", "Value", base.DEC),
  crc = ProtoField.uint16("epos2.crc", "CRC", base.HEX),
  crc_good = ProtoField.bool("epos2.crc_good", "CRC is right"),
  handshake = ProtoField.string("epos2.handshake", "Handshake"),
  request = ProtoField.framenum("epos2.request", "Request", base.NONE, frametype.REQUEST),
  time = ProtoField.double("epos2.time", "Time since request, s"),
}
epos2.fields = f
local bad_crc = ProtoExpert.new("epos2.bad_crc", "wrong CRC", expert.group.CHECKSUM, expert.severity.ERROR)
local refused = ProtoExpert.new("epos2.refused", "the drive refused", expert.group.RESPONSE_CODE, expert.severity.WARN)
local incomplete = ProtoExpert.new("epos2.incomplete", "incomplete frame", expert.group.MALFORMED, expert.severity.WARN)
epos2.experts = { bad_crc, refused, incomplete }

-- What the bytes before a record decide: per record on RS232 its part of the exchange, per answer its request.
local parts, requests = {}, {}
local expected, opcode_sent, open

function epos2.init()
  parts, requests = {}, {}
  expected, opcode_sent, open = "opcode", nil, nil
end

-- CRC-16/XMODEM over 16-bit words, the high byte of each first.
local function crc16(words)
  local crc = 0
  for _, word in ipairs(words) do
    crc = bit.bxor(crc, word)
    for _ = 1, 16 do
      crc = bit.lshift(crc, 1)
      if bit.band(crc, 0x10000) ~= 0 then crc = bit.bxor(crc, 0x11021) end
    end
  end
  return crc
end

-- A frame without its stuffing and synchronisation: opcode, header of the CRC, number of words, bytes of the data and CRC.
local function dissect_frame(bytes, pinfo, tree, opcode, header, words)
  local number, is_answer = pinfo.number, opcode == 0
  tree:add(f.opcode, opcode)
  tree:add(f.words, words)
  if bytes:len() < 2 * words + 2 then
    tree:add_proto_expert_info(incomplete)
    pinfo.cols.info = "incomplete frame"
    return
  end
  local data = {}
  for i = 0, words - 1 do data[i + 1] = bytes:get_index(2 * i) + 256 * bytes:get_index(2 * i + 1) end
  local fed = { header }
  for _, word in ipairs(data) do fed[#fed + 1] = word end
  local crc = bytes:get_index(2 * words) + 256 * bytes:get_index(2 * words + 1)
  local is_good = crc16(fed) == crc
  local info = commands[opcode] or string.format("Opcode 0x%02X", opcode)
  if not pinfo.visited then
    if is_answer then requests[number] = open else open = nil end
  end
  local asked = requests[number]
  local object = asked
  if with_object[opcode] and words >= 2 then
    object = {
      index = data[1], subindex = data[2] % 256, node = math.floor(data[2] / 256), opcode = opcode,
      number = number, time = pinfo.rel_ts,
    }
    if not pinfo.visited then open = object end
  elseif not is_answer and not pinfo.visited then
    open = { opcode = opcode, number = number, time = pinfo.rel_ts }
  end
  if object and object.index then
    local parts_of = { tree:add(f.index, object.index), tree:add(f.subindex, object.subindex), tree:add(f.node, object.node) }
    local known = objects[object.index]
    if known then parts_of[4] = tree:add(f.name, known[1]) end
    if is_answer then for _, part in ipairs(parts_of) do part:set_generated() end end
    info = string.format("%s %04X:%02X%s", info, object.index, object.subindex, known and " " .. known[1] or "")
  end
  local function value(low, high)
    local known = objects[object.index]
    local width = known and known[2] or 32
    if object.subindex == 0 and several[object.index] then width = 8 end
    local range = 2 ^ math.abs(width)
    local number_of = (low + 65536 * high) % range
    if width < 0 and number_of >= range / 2 then number_of = number_of - range end
    tree:add(f.value, Int64.new(number_of % 2 ^ 32, number_of < 0 and 0xFFFFFFFF or 0))
    info = string.format("%s = %d", info, number_of)
  end
  if is_answer and words >= 2 then
    local code = data[1] + 65536 * data[2]
    tree:add(f.error, code)
    if code ~= 0 then
      tree:add_proto_expert_info(refused)
      info = string.format("%s: error %08X", info, code)
    elseif words >= 4 and asked and asked.opcode == 0x10 then
      value(data[3], data[4])
    end
  elseif opcode == 0x11 and words >= 4 then
    value(data[3], data[4])
  end
  tree:add(f.crc, crc)
  tree:add(f.crc_good, is_good):set_generated()
  if not is_good then tree:add_proto_expert_info(bad_crc) end
  if asked then
    tree:add(f.request, asked.number):set_generated()
    tree:add(f.time, pinfo.rel_ts - asked.time):set_generated()
  end
  pinfo.cols.info = info .. (is_good and "" or ", wrong CRC")
end

-- USB: 90 02, opcode, words, data, CRC; every 90 after the first two bytes is doubled.
local function dissect_usb(bytes, pinfo, tree)
  local plain = ByteArray.new()
  plain:set_size(bytes:len())
  local length, i = 0, 2
  while i < bytes:len() do
    plain:set_index(length, bytes:get_index(i))
    length = length + 1
    i = i + (bytes:get_index(i) == 0x90 and 2 or 1)
  end
  plain:set_size(length)
  if length < 2 then
    tree:add_proto_expert_info(incomplete)
    pinfo.cols.info = "incomplete frame"
    return
  end
  local opcode, words = plain:get_index(0), plain:get_index(1)
  dissect_frame(plain:subset(2, length - 2), pinfo, tree, opcode, 256 * words + opcode, words)
end

-- RS232: opcode, acknowledgement, words - 1 with data and CRC, acknowledgement; the answer likewise.
local after = { opcode = "accept", accept = "body", body = "taken", taken = "answer", answer = "ready", ready = "answer body",
  ["answer body"] = "read", read = "opcode" }
local from_program = { opcode = true, body = true, ready = true, read = true }

local function dissect_rs232(bytes, pinfo, tree)
  local to_drive = pinfo.p2p_dir == 0
  if not pinfo.visited then
    -- Lost bytes: the exchange begins again with the program's next opcode.
    if (from_program[expected] or false) ~= to_drive then expected = to_drive and "opcode" or "accept" end
    local made, i = {}, 0
    while i < bytes:len() do
      local part = { kind = expected, first = i }
      if expected == "opcode" or expected == "answer" then
        part.opcode = bytes:get_index(i)
        opcode_sent, part.length = part.opcode, 1
      elseif expected == "body" or expected == "answer body" then
        part.opcode = opcode_sent
        part.length = math.min(2 * bytes:get_index(i) + 5, bytes:len() - i)
      else
        part.length = 1
        if bytes:get_index(i) ~= 0x4F then part.is_refusal = true end
      end
      made[#made + 1] = part
      i = i + part.length
      expected = part.is_refusal and "opcode" or after[expected]
    end
    parts[pinfo.number] = made
  end
  local texts = {}
  for _, part in ipairs(parts[pinfo.number] or {}) do
    local own = bytes:subset(part.first, part.length)
    if part.kind == "body" or part.kind == "answer body" then
      local words = own:get_index(0) + 1
      local rest = own:len() > 1 and own:subset(1, own:len() - 1) or ByteArray.new()
      dissect_frame(rest, pinfo, tree, part.opcode, 256 * part.opcode + words - 1, words)
      texts[#texts + 1] = tostring(pinfo.cols.info)
    elseif part.opcode then
      tree:add(f.opcode, part.opcode)
      texts[#texts + 1] = "opcode of " .. (commands[part.opcode] or string.format("0x%02X", part.opcode))
    else
      local text = part.is_refusal and "refused" or "accepted"
      tree:add(f.handshake, text)
      texts[#texts + 1] = text
    end
  end
  pinfo.cols.info = table.concat(texts, ", ")
end

function epos2.dissector(buffer, pinfo, root)
  local bytes = buffer():bytes()
  pinfo.cols.protocol = "EPOS2"
  local tree = root:add(epos2, buffer())
  if bytes:len() >= 2 and bytes:get_index(0) == 0x90 and bytes:get_index(1) == 0x02 then
    dissect_usb(bytes, pinfo, tree)
  else
    dissect_rs232(bytes, pinfo, tree)
  end
  return buffer:len()
end

DissectorTable.get("wtap_encap"):add(wtap.USER0, epos2)
