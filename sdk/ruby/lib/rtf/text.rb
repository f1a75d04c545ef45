# frozen_string_literal: true

module RTF
  # How values are written in messages: alike in all languages that have an SDK.
  module Text
    module_function

    # As C's %.6g, so that all SDKs print the same.
    def number(value)
      return "nan" if value.nan?
      return value.negative? ? "-inf" : "inf" if value.infinite?

      format("%.6g", value)
    end

    # The last value of a condition that never came true.
    def value(thing)
      case thing
      when nil then "nil"
      when Float then number(thing)
      else thing.to_s
      end
    end

    # A measurement outside its limits: `rate: 87.5 Hz is outside 95 … 105`.
    def violation(name, measured, unit, low, high)
      return "#{name}: not a finite number" unless measured.finite?

      text = "#{name}: #{exact(measured)} #{unit}".rstrip
      return "#{text} is outside #{exact(low)} … #{exact(high)}" if low && high
      return "#{text} is outside ≥ #{exact(low)}" if low
      return "#{text} is outside ≤ #{exact(high)}" if high

      text
    end

    # With all digits: a value just outside a limit looks different from it.
    def exact(value)
      value.to_s.delete_suffix(".0")
    end

    # Any object's text in UTF-8, which is what the protocol carries.
    def utf8(thing)
      text = thing.to_s
      case text.encoding
      when Encoding::UTF_8, Encoding::US_ASCII, Encoding::BINARY
        text.dup.force_encoding(Encoding::UTF_8).scrub("\uFFFD")
      else
        text.encode(Encoding::UTF_8, invalid: :replace, undef: :replace, replace: "\uFFFD")
      end
    end
  end
end
