# frozen_string_literal: true

module RTF
  # Formats values in messages: the same in all SDKs (see conformance/texts.json).
  module Text
    module_function

    # Like C's %.6g.
    def number(value)
      return "nan" if value.nan?
      return value.negative? ? "-inf" : "inf" if value.infinite?

      format("%.6g", value)
    end

    # The last value of a condition.
    def value(thing)
      case thing
      when nil then "nil"
      when Float then number(thing)
      else thing.to_s
      end
    end

    # Any object's text in UTF-8, the protocol's encoding.
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
