# frozen_string_literal: true

module RTF
  # Checks values that a plug-in sends: `JSON.generate` encodes any object, as its `to_s`.
  module JsonValue
    # `JSON.generate` allows 100 levels, of which a line of the protocol takes two.
    LEVELS = 98

    module_function

    # Why a value is no JSON, as text; nil if it is.
    def problem(value, level = 1)
      case value
      when nil, true, false, Integer, String, Symbol then nil
      when Float then "not JSON: #{Text.number(value)}" unless value.finite?
      when Array, Hash then problem_inside(value, level)
      else "not JSON: #{value.class}"
      end
    end

    def problem_inside(value, level)
      return "not JSON: more than #{LEVELS} levels" if level > LEVELS

      inner = value.is_a?(Hash) ? value.values : value
      inner.each do |entry|
        found = problem(entry, level + 1)
        return found if found
      end
      nil
    end
  end
end
