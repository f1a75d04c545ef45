with Ada.Strings.Fixed; use Ada.Strings.Fixed;
with Ada.Strings; use Ada.Strings;
with Interfaces.C; use Interfaces.C;
with RobotTestingFramework.Asserter; use RobotTestingFramework.Asserter;

package body Plugin is

   function Read_Link (Path : char_array; Target : out String; Size : size_t) return long
     with Import, Convention => C, External_Name => "readlink";

   function Write (Descriptor : int; Bytes : String; Count : size_t) return long
     with Import, Convention => C, External_Name => "write";

   overriding procedure Run (Self : in out Test) is
      --  Writes an invalid line to every socket of the process: one of them is
      --  the channel.
      Line   : constant String := "this is not a message" & ASCII.LF;
      Target : String (1 .. 64);
      Length : long;
   begin
      Report ("before the garbage");
      for Descriptor in int range 3 .. 255 loop
         Target := (others => ' ');
         Length := Read_Link
           (To_C ("/proc/self/fd/" & Trim (Descriptor'Image, Left)), Target, Target'Length);
         if Length > 7 and then Target (1 .. 7) = "socket:" then
            ErrorIf (Write (Descriptor, Line, Line'Length) = Line'Length, "can write");
         end if;
      end loop;
   end Run;

end Plugin;
