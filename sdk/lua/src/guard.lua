-- Calls a function of the plug-in, catches its errors, and returns how it ended.
local text, stop = ...

-- Taken before the plug-in can replace them.
local getinfo, traceback, xpcall = debug.getinfo, debug.traceback, xpcall
local match = string.match

local guard = {}

-- The chunk name of the SDK's code.
local OWN_SOURCE = "=rtf"

-- The innermost line of the plug-in, from `level` of the caller on.
function guard.location(level)
  level = level + 1
  local info = getinfo(level, "Sl")
  while info do
    if info.currentline > 0 and info.source ~= OWN_SOURCE then
      return match(info.source, "^@(.*)$") or info.short_src, info.currentline
    end
    level = level + 1
    info = getinfo(level, "Sl")
  end
  return nil, nil
end

-- Removes the position that Lua adds to a message: the location is sent separately.
local function without_position(message, line)
  local before, rest = match(message, "^.-:(%d+): (.*)$")
  if before and tonumber(before) == line then
    return rest
  end
  return message
end

-- The lines of a traceback that belong to the plug-in.
local function stack()
  local lines = {}
  for line in traceback("", 3):gmatch("[^\n]+") do
    if not line:find("^%s*rtf:%d+:") and not line:find("^%s*%[C%]: in %?$") then
      lines[#lines + 1] = line
    end
  end
  -- The host's call is the last line.
  while lines[#lines] and lines[#lines]:find("'xpcall'", 1, true) do
    lines[#lines] = nil
  end
  return table.concat(lines, "\n")
end

local function handler(problem)
  if problem == stop then
    return stop
  end
  local file, line = guard.location(2)
  local message = without_position(text.raised(problem), line)
  return { text = message .. "\n" .. stack(), file = file, line = line }
end

-- Returns "done" and what the function returned, "stopped", or "broken" with
-- the text, the file and the line.
function guard.call(called, ...)
  local good, result = xpcall(called, handler, ...)
  if good then
    return "done", result
  elseif result == stop then
    return "stopped"
  elseif type(result) == "table" then
    return "broken", result.text, result.file, result.line
  end
  -- The stack is exhausted, so the handler could not run.
  return "broken", tostring(result)
end

return guard
