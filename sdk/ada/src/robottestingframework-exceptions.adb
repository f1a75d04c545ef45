--  SPDX-License-Identifier: Apache-2.0

with RobotTestingFramework.ABI;
with RobotTestingFramework.Host;

package body RobotTestingFramework.Exceptions is

   --  The location in a text of the compiler: `arm.adb:12 index check failed`.
   procedure Find_Location (Text : String; Last : out Natural; Line : out Natural) is
   begin
      Last := 0;
      Line := 0;
      for Index in Text'First .. Text'Last - 4 loop
         if Text (Index .. Index + 4) in ".adb:" | ".ads:" then
            for Digit of Text (Index + 5 .. Text'Last) loop
               exit when Digit not in '0' .. '9' or else Line > 100_000_000;
               Line := Line * 10 + Character'Pos (Digit) - Character'Pos ('0');
            end loop;
            Last := Index + 3;
            return;
         end if;
         exit when Text (Index) = ' ';
      end loop;
   end Find_Location;

   procedure Report (Raised : Ada.Exceptions.Exception_Occurrence) is
      Text  : constant String := Ada.Exceptions.Exception_Message (Raised);
      Known : constant String := Ada.Exceptions.Exception_Information (Raised);
      Trace : Natural         := Known'First;
      Last  : Natural;
      Line  : Natural;
   begin
      while Trace <= Known'Last and then Known (Trace) /= ASCII.LF loop
         Trace := Trace + 1;
      end loop;
      Find_Location (Text, Last, Line);
      Host.Send
        (Kind  => ABI.Error,
         Content => Ada.Exceptions.Exception_Name (Raised) & ": " & Text
           & (if Trace < Known'Last then Known (Trace .. Known'Last - 1) else ""),
         File  => (if Last = 0 then "" else Text (Text'First .. Last)),
         Line  => Line);
   end Report;

end RobotTestingFramework.Exceptions;
