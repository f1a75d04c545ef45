-- The channel's descriptor: the one socket of this process. It is closed in
-- children, and cannot be opened by its name.
local function channel()
  local descriptors = io.popen("ls -l /proc/$PPID/fd")
  local number = descriptors:read("a"):match("(%d+) %-> socket:")
  descriptors:close()
  return tonumber(number)
end

function TestCase.run()
  rtf.report("before the garbage")
  local number = channel()
  local socket = require("socket")
  local server = assert(socket.bind("127.0.0.1", 0))
  local _, port = server:getsockname()
  local client = assert(socket.connect("127.0.0.1", port))
  local own = client:getfd()
  client:setfd(number)
  client:send("this is not a message\n")
  client:setfd(own)
end
