# frozen_string_literal: true

module RTF
  VERSION = "0.1.0"
end
