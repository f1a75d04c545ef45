-- How values are written in messages: alike in all languages that have an SDK.
local text = {}

-- As C's %.6g, so that all SDKs print the same.
function text.number(number)
  if number ~= number then
    return "nan"
  end
  return ("%.6g"):format(number)
end

-- The last value of a condition that never came true.
function text.value(value)
  if math.type(value) == "float" then
    return text.number(value)
  end
  return tostring(value)
end

local function entry(value)
  return type(value) == "string" and ("'%s'"):format(value) or text.value(value)
end

local function by_name(a, b)
  return tostring(a) < tostring(b)
end

-- What was raised with error(): a string is its own text, anything else is
-- named with its type.
function text.raised(problem)
  if type(problem) == "string" then
    return problem
  end
  local shown = tostring(problem)
  local meta = getmetatable(problem)
  if type(problem) == "table" and not (type(meta) == "table" and (meta.__tostring or meta.__name)) then
    local names, parts = {}, {}
    for name in pairs(problem) do
      names[#names + 1] = name
    end
    table.sort(names, by_name)
    for index, name in ipairs(names) do
      parts[index] = ("%s = %s"):format(tostring(name), entry(problem[name]))
    end
    shown = ("{%s}"):format(table.concat(parts, ", "))
  end
  return ("an error of type %s was raised: %s"):format(type(problem), shown)
end

return text
