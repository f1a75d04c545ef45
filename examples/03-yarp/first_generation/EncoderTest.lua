-- Are there six encoders, each within its circle? Written for RTF 1.x.
require("yarp")

local network, port

TestCase = {}

TestCase.setup = function(parameter)
  local from = parameter:match("%-%-from%s+(%S+)")
  if not from then
    RTF.assertError("tell the port: --from /name")
  end
  network = yarp.Network()
  port = yarp.BufferedPortBottle()
  if not port:open("/EncoderTest/encoders:i") then
    RTF.assertError("cannot open a port")
  end
  return yarp.NetworkBase_connect(from, "/EncoderTest/encoders:i")
end

TestCase.run = function()
  local encoders = port:read(true)
  RTF.testCheck(encoders:size() == 6, "there are six encoders")
  for i = 0, encoders:size() - 1 do
    local degrees = encoders:get(i):asFloat64()
    RTF.testCheck(math.abs(degrees) <= 180, ("encoder %d: %.1f degrees"):format(i, degrees))
  end
end

TestCase.tearDown = function()
  port:close()
end

return TestCase
