-- Formats values in messages: the same in all SDKs (see conformance/texts.json).
local text = {}

-- Like C's %.6g.
function text.number(number)
  if number ~= number then
    return "nan"
  end
  return ("%.6g"):format(number)
end

-- The last value of a condition.
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

-- Describes a raised value: a string is the text itself, anything else is described with
-- its type.
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
