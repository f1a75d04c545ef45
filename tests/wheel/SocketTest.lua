-- Loads a C module, which needs the functions of Lua in the host.
TestCase = {}

function TestCase.run()
  local socket = require("socket")
  rtf.check(socket.gettime() > 0, "the module works")
end
