-- Do the head's encoders tell where it is, again and again?
require("yarp")

local JOINTS = 6
local SAMPLES = 25

local network
local port

-- The next encoders, in degrees. Looked for again and again, so that the test can be stopped.
local function next_encoders()
  local bottle
  rtf.wait_until(function()
    bottle = port:read(false)
    return bottle
  end, 5, "encoders")
  local degrees = {}
  for i = 0, bottle:size() - 1 do
    degrees[i + 1] = bottle:get(i):asFloat64()
  end
  return degrees
end

TestCase = {}

function TestCase.setup(args)
  network = yarp.Network()
  port = yarp.BufferedPortBottle()
  assert(args[1] == "--from", "tell the port: --from /name")
  assert(port:open("/HeadTest/encoders:i"))
  return yarp.NetworkBase_connect(args[2], "/HeadTest/encoders:i")
end

function TestCase.run()
  local first = next_encoders()
  rtf.require(#first == JOINTS, ("there are %d encoders"):format(JOINTS))
  for _ = 1, SAMPLES do
    local now = next_encoders()
    for joint = 1, JOINTS do
      rtf.check_near(now[joint], first[joint], 0.5, ("joint %d, which nobody moves"):format(joint))
    end
  end
end

function TestCase.tearDown()
  if port then
    port:close()
  end
end
