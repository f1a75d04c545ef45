-- Does every joint stay within its limits, also when it is sent beyond them?
require("yarp")

local BEYOND_DEG = 30
local SLACK_DEG = 2

local network
local state, command, rpc
local prefix

local function ask(question)
  local asked, answer = yarp.Bottle(), yarp.Bottle()
  asked:fromString(question)
  assert(rpc:write(asked, answer), prefix .. "/rpc:i does not answer")
  return answer
end

-- The next encoders, in degrees.
local function encoders()
  local values
  rtf.wait_until(function()
    values = state:read(false)
    return values
  end, 5, "encoders")
  local degrees = {}
  for i = 0, values:size() - 1 do
    degrees[i + 1] = values:get(i):asFloat64()
  end
  return degrees
end

local function send(targets)
  local values = command:prepare()
  values:clear()
  for _, degrees in ipairs(targets) do
    values:addFloat64(degrees)
  end
  command:writeStrict()
end

-- Waits until the joint moves less than 0.05 degrees in 0.1 s.
local function rest(joint)
  local before = math.huge
  rtf.wait_until(function()
    rtf.sleep(0.1)
    local now = encoders()[joint]
    local moved = math.abs(now - before)
    before = now
    return moved < 0.05
  end, 15, ("joint %d to stand still"):format(joint))
  return before
end

TestCase = {}

function TestCase.setup(args)
  assert(args[1] == "--part", "tell the part: --part /icubSim/head")
  prefix = args[2]
  network = yarp.Network()
  state, command, rpc = yarp.BufferedPortBottle(), yarp.BufferedPortBottle(), yarp.RpcClient()
  assert(state:open("/LimitsTest/state:i"))
  assert(command:open("/LimitsTest/command:o"))
  assert(rpc:open("/LimitsTest/rpc:o"))
  return yarp.NetworkBase_connect(prefix .. "/state:o", "/LimitsTest/state:i")
    and yarp.NetworkBase_connect("/LimitsTest/command:o", prefix .. "/command:i")
    and rpc:addOutput(prefix .. "/rpc:i")
end

function TestCase.run()
  local names, limits = ask("get names"), ask("get limits")
  local home = encoders()
  rtf.require(names:size() == #home, "a name for each encoder")
  for joint = 1, #home do
    local name = names:get(joint - 1):asString()
    for side, sign in pairs({ low = -1, high = 1 }) do
      local limit = limits:get(2 * (joint - 1) + (side == "low" and 0 or 1)):asFloat64()
      local target = { table.unpack(home) }
      target[joint] = limit + sign * BEYOND_DEG
      send(target)
      local reached = rest(joint)
      rtf.measure(("%s at its %s limit"):format(name, side), reached - limit, "deg", -SLACK_DEG, SLACK_DEG)
    end
    send(home)
    rest(joint)
  end
end

function TestCase.tearDown()
  for _, port in pairs({ state, command, rpc }) do
    port:close()
  end
end
