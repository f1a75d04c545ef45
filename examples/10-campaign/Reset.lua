-- Brings the simulator into the first state of the next episode.
local socket = require("socket")

local CONDITIONS = { "RTF_PARAM_PAYLOAD", "RTF_PARAM_FRICTION", "RTF_PARAM_NOISE", "RTF_EPISODE_SEED" }

TestCase = {}

function TestCase.run()
  local words = { "reset" }
  for _, name in ipairs(CONDITIONS) do
    words[#words + 1] = assert(os.getenv(name), name .. " is not set")
  end
  local arm = assert(socket.connect("127.0.0.1", tonumber(os.getenv("ARM_PORT"))))
  arm:settimeout(10)
  assert(arm:send(table.concat(words, " ") .. "\n"))
  local answer = assert(arm:receive("*l"))
  arm:close()
  rtf.check(answer == "ok", answer)
end
