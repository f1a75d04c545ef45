-- Do the encoders tell the truth? At rest they must be quiet and within their
-- joint's limits; when a joint moves, its encoder must count in that direction.
local socket = require("socket")

local PORT = tonumber(os.getenv("ARM_PORT") or "17681")
local SAMPLES = 200

local arm
local joints = {}

-- Sends a line and returns what the arm answers after `ok`.
local function ask(line)
  assert(arm:send(line .. "\n"))
  local answer = assert(arm:receive("*l"))
  local text = answer:match("^ok ?(.*)$")
  if not text then
    rtf.error(("`%s`: %s"):format(line, answer))
  end
  return text
end

local function position(joint)
  return tonumber(ask("get " .. joint))
end

-- Waits until the joint moves less than 0.1 mrad in 50 ms of the simulator's time:
-- on a busy machine a simulator that was not scheduled looks like an arm at rest.
local function rest(joint)
  local before, since = math.huge, -math.huge
  rtf.wait_until(function()
    local time = tonumber(ask("time"))
    if time - since < 0.05 then
      return false
    end
    local now = position(joint)
    local moved = math.abs(now - before)
    before, since = now, time
    return moved < 1e-4
  end, 5, joint .. " to stand still")
end

TestCase = {}

function TestCase.setup(args)
  arm = assert(socket.connect("127.0.0.1", PORT))
  arm:settimeout(10)
  arm:setoption("tcp-nodelay", true)
  for joint in ask("joints"):gmatch("%S+") do
    joints[#joints + 1] = joint
  end
  rtf.report("encoders: " .. table.concat(joints, ", "))
  return #joints > 0
end

-- At rest: within the limits, and quiet.
local function check_at_rest(joint)
  local low, high = ask("limits " .. joint):match("(%S+) (%S+)")
  local smallest, largest = math.huge, -math.huge
  for _ = 1, SAMPLES do
    local radians = position(joint)
    smallest, largest = math.min(smallest, radians), math.max(largest, radians)
  end
  rtf.check(smallest >= tonumber(low) and largest <= tonumber(high),
    ("%s is between %s and %s rad"):format(joint, low, high))
  rtf.measure("noise of " .. joint, largest - smallest, "rad", 0, 0.002)
end

-- In motion: the encoder follows, in the right direction and by the right amount.
local function check_direction(joint)
  local start = position(joint)
  for _, step in ipairs({ 0.2, -0.2 }) do
    ask(("set %s %f"):format(joint, step))
    rtf.wait_until(function()
      return math.abs(position(joint) - step) < 0.02
    end, 5, ("%s at %.1f rad"):format(joint, step))
  end
  ask(("set %s 0"):format(joint))
  rest(joint)
  rtf.check_near(position(joint), start, 0.03, joint .. " back at its start")
end

function TestCase.run()
  for _, joint in ipairs(joints) do
    rest(joint)
    check_at_rest(joint)
    check_direction(joint)
  end
end

function TestCase.tearDown()
  if arm then
    arm:close()
  end
end
