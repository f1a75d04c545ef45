-- Returns `rtf.fault`, which injects faults that the suite declares.
local host, guard, stop = ...

-- Taken before the plug-in can replace them.
local error, tostring, setmetatable = error, tostring, setmetatable

-- Injects or removes a fault. The host has reported a problem, which ends the step.
local function request(verb, name, level)
  local file, line = guard.location(level + 1)
  if not host.fault(verb, name, file, line) then
    error(stop, 0)
  end
end

local Fault = {}
Fault.__index = Fault
Fault.__name = "rtf.Fault"

function Fault:remove()
  request("remove", self.name, 2)
end

-- At the end of the block of a variable with the attribute `close`.
function Fault:__close()
  request("remove", self.name, 2)
end

return function(name)
  local fault = setmetatable({ name = tostring(name) }, Fault)
  request("inject", fault.name, 2)
  return fault
end
